"""What is measured: one definition each, used everywhere."""

from numpy_cae.measures.jitter import jitter
from numpy_cae.measures.position_error import position_error

__all__ = ["jitter", "position_error"]
