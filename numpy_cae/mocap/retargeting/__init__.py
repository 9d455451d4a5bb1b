"""Conversion of a motion of any rig to the twenty joints and back."""
