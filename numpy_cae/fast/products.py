"""Many small matrix products at full speed: in pieces, and in arrays that start at a cache line.

BLAS copies the factors of a large product into a layout of its own ("packing"). That is negligible
beside n³ multiplications, and half of the work where one side has 30 rows. OpenBLAS omits the copy
for products of up to a million multiplications: its kernels for small matrices then run at the
peak, where the same product in one piece reaches half of it (measured at 30 rows by 128 by 256).
So the products are cut. The values are the same sums; other BLAS libraries lose nothing.

NumPy's large arrays start 16 bytes after a page, so that every second vector of 32 bytes, or each
of 64, lies on two cache lines. In arrays that start at a cache line, sums and products of two
float32 arrays take 0.10 instead of 0.20 ns an element, and small matrix products up to a third less
time.
"""

import numpy as np

MAX_UNPACKED = 1_000_000
"""Multiplications of a product that is not packed (OpenBLAS, `sgemm_small_matrix_permit`)."""

MAX_UNPACKED_TRANSPOSED = 1200
"""Elements of the result of a product that is not packed, its second factor transposed."""

ROWS, COLUMNS = 16, 512
"""Rows and columns of a piece, at most. The kernels compute 8 or 16 rows at a time, and a piece of
another height is up to twice as slow; wider pieces leave the first level of the cache."""

CACHE_LINE = 64
"""Bytes."""


def aligned_empty(shape: tuple[int, ...], dtype: np.dtype | type) -> np.ndarray:
    """As `np.empty`, the first element at a multiple of `CACHE_LINE`."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    memory = np.empty(size + CACHE_LINE, np.uint8)
    start = -memory.ctypes.data % CACHE_LINE
    return memory[start : start + size].view(dtype).reshape(shape)


def multiply_rows(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    """out[s] = a[s] · b[s], in groups of rows of each a[s].

    a is (S, R, M), b is (S, M, N), possibly a transposed view, and out is (S, R, N).
    """
    inner, columns = b.shape[1:]
    rows = min(ROWS, MAX_UNPACKED // max(inner * columns, 1))
    if b.strides[-1] != b.itemsize:
        rows = min(rows, MAX_UNPACKED_TRANSPOSED // max(columns, 1))
    _in_groups(a, b, out, rows // 8 * 8 or max(rows, 1))


def multiply_columns(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    """out[j] = a · b[j] for one constant matrix a, in groups of columns of each b[j].

    a is (M, K), b is (J, K, W), and out is (J, M, W).
    """
    width = b.shape[-1]
    at_once = min(COLUMNS, max(MAX_UNPACKED // max(a.size, 1) // 16 * 16, 16))
    whole = width // at_once * at_once
    if whole:
        pieces = _by_columns(out[..., :whole], at_once)
        np.matmul(a, _by_columns(b[..., :whole], at_once), out=pieces)
    if whole < width:
        np.matmul(a, b[..., whole:], out=out[..., whole:])


def _in_groups(a: np.ndarray, b: np.ndarray, out: np.ndarray, rows: int) -> None:
    """Groups of `rows` rows; for each s they follow one another, while b[s] is in the cache."""
    products, total, _ = a.shape
    whole = total // rows * rows
    if whole:
        groups = products, whole // rows, rows
        np.matmul(
            a[:, :whole].reshape(*groups, a.shape[-1]),
            b[:, None],
            out=out[:, :whole].reshape(*groups, out.shape[-1]),
        )
    if whole < total:
        np.matmul(a[:, whole:], b, out=out[:, whole:])


def _by_columns(array: np.ndarray, at_once: int) -> np.ndarray:
    """(J, K, W) as (J, W / at_once, K, at_once), the same memory."""
    count, rows, width = array.shape
    return array.reshape(count, rows, width // at_once, at_once).transpose(0, 2, 1, 3)


class RowGroups:
    """out = a · b for the same contiguous a and out and many b of few columns, by groups of rows.

    The kernels compute 4 rows of 64 columns at a time, or 6 rows of fewer columns.
    """

    def __init__(self, a: np.ndarray, out: np.ndarray):
        inner, columns = a.shape[1], out.shape[1]
        multiple = 4 if columns % 64 == 0 else 6
        unpacked = MAX_UNPACKED // (inner * columns) // multiple * multiple
        rows = min(unpacked or len(a), len(a))
        whole = len(a) // rows * rows
        self._pairs = [[part[:whole].reshape(-1, rows, part.shape[1]) for part in (a, out)]]
        if whole < len(a):
            self._pairs.append([a[whole:], out[whole:]])

    def __call__(self, b: np.ndarray) -> None:
        """Compute `out` from b, (K, N)."""
        for rows, out in self._pairs:
            np.matmul(rows, b, out=out)
