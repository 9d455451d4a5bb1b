"""The speed of a large matrix product in this process."""

from __future__ import annotations

import time

import numpy as np


def matrix_product_peak(size: int = 2048, rounds: int = 12) -> float:
    """Floating point operations a second of a product of float32 (size, size) matrices; the best
    of so many rounds."""
    rng = np.random.default_rng(0)
    a, b = (rng.random((size, size), dtype=np.float32) for _ in range(2))
    out = np.empty_like(a)
    np.matmul(a, b, out=out)
    best = np.inf
    for _ in range(rounds):
        start = time.perf_counter()
        np.matmul(a, b, out=out)
        best = min(best, time.perf_counter() - start)
    return 2 * size**3 / best
