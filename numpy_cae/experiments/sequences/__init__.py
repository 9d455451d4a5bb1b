"""Experiments: sequences."""
