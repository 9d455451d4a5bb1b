"""Experiments: filters."""
