"""Experiments: repair."""
