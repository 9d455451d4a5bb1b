"""The commands of `numpy-cae`, one module each."""
