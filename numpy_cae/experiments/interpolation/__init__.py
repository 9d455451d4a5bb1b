"""Experiments: interpolation."""
