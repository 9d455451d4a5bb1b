"""Damage that the file itself shows: a jump, a repeated value, a bone of another length, a foot
that slides. One file a step; `finding` is what all of them report."""
