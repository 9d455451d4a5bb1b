"""Kept until the last experiment returns a Result."""

from numpy_cae.experiments.result import text_table  # noqa: F401
