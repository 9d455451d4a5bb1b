"""The speed of a large matrix product, with which other computations are compared.

It has a module of its own, which imports no PyTorch: lesson 13 uses it.
"""

from timeit import repeat

import numpy as np


def matrix_product_peak(size: int = 2048, rounds: int = 12) -> float:
    """Operations a second of a product of float32 (size, size) matrices, the best of the rounds."""
    a, b = np.random.default_rng(0).random((2, size, size), dtype=np.float32)
    out = np.empty_like(a)
    return 2 * size**3 / min(repeat(lambda: np.matmul(a, b, out=out), number=1, repeat=rounds))
