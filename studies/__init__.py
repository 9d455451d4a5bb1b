"""Measurements behind docs/results.md and the lab book: `python -m studies NAME`, in a clone.

Each module here answers one question by a function `run(...) -> Result`; the folders have what
several of them need.
"""
