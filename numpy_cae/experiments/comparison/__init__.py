"""Experiments: comparison."""
