"""The directions that the sliced Wasserstein distance projects on."""

from __future__ import annotations

import numpy as np


def unit_directions(
    count: int, dimensions: int, rng: np.random.Generator, dtype: np.dtype | type = np.float32
) -> np.ndarray:
    """Rows of length 1, every direction as likely as any other: (count, dimensions).

    A normal draw has no preferred direction, and dividing it by its length gives it none.
    """
    drawn = rng.standard_normal((count, dimensions))
    return (drawn / np.linalg.norm(drawn, axis=1, keepdims=True)).astype(dtype)
