"""Many small matrix products at full speed: in pieces, and in arrays that start at a cache line.

BLAS copies the factors of a large product into a layout of its own ("packing"). That is negligible
beside n³ multiplications, and half of the work where one side has 30 rows. OpenBLAS's kernel for
AVX-512 omits the copy for products of up to a million multiplications: it then runs at the peak,
where the same product in one piece reaches half of it (measured at 30 rows by 128 by 256). So with
this kernel the products are cut. The values are the same sums. Kernels that always copy lose by the
cut, that for Haswell up to half of the time of a step (docs/lab_book/engine.md).

NumPy's large arrays start 16 bytes after a page, so that every second vector of 32 bytes, or each
of 64, lies on two cache lines. In arrays that start at a cache line, sums and products of two
float32 arrays take 0.10 instead of 0.20 ns an element, and small matrix products up to a third less
time.
"""

import sys
import threading
import weakref

import numpy as np

from numpy_cae.fast.thread_team import blas_kernel

OMITS_PACKING = blas_kernel() == "SkylakeX"
"""Whether BLAS uses OpenBLAS's kernel for AVX-512, by the name of the first such processors."""

MAX_UNPACKED = 1_000_000 if OMITS_PACKING else sys.maxsize
"""A product of at most this many multiplications is one piece: with the kernel for AVX-512 those
that are not packed (its constant `sgemm_small_matrix_permit`), with another one all."""

MAX_UNPACKED_TRANSPOSED = 1200 if OMITS_PACKING else sys.maxsize
"""A product with a transposed second factor is one piece if its result has at most this many
elements: a constant of the same kernel."""

ROWS = 24
"""A piece has at most this many rows. The kernel computes 4, 6 or 8 rows at a time, and a piece of
another height is up to twice as slow."""

COLUMNS = 512
"""A piece has at most this many columns; wider pieces leave the first level of the cache. Measured
on one machine."""

CACHE_LINE_BYTES = 64
"""Every array starts at a multiple of this address."""

ROW_PADDING = 16
"""So many numbers are added to each row of a buffer. Rows whose distance is a power of two are
mapped to the same lines of the cache, and a product along the columns then takes a quarter
longer."""


MAX_KEPT_BITS = 26
"""The memory of an array of more bytes than a number of so many bits is not kept for the next."""


class _Released(threading.local):
    """Memory that no array uses any more, of this thread: it is in the cache of its core."""

    def __init__(self) -> None:
        self.by_bits: dict[int, list[bytearray]] = {}  # the bits of its size


_released = _Released()


def aligned_empty(shape: tuple[int, ...], dtype: np.dtype | type) -> np.ndarray:
    """As `np.empty`, the first element at a multiple of `CACHE_LINE_BYTES`.

    The memory is that of an earlier array of about this size, if no view of it is left. (The system
    takes unused memory back and clears it page by page when it is used again: a fifth of a step.)
    """
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    bits = (size + CACHE_LINE_BYTES).bit_length()
    released = _released.by_bits.setdefault(bits, [])
    memory = released.pop() if released else bytearray(1 << bits)
    octets = np.frombuffer(memory, np.uint8)  # every view of it keeps it alive
    if bits <= MAX_KEPT_BITS:
        weakref.finalize(octets, released.append, memory)
    start = -octets.ctypes.data % CACHE_LINE_BYTES
    return octets[start : start + size].view(dtype).reshape(shape)


def zeros(shape: tuple[int, ...], dtype: np.dtype | type) -> np.ndarray:
    """As `np.zeros`, aligned, with `ROW_PADDING` between the elements of the first axis."""
    array = Memory(np.dtype(dtype))(*shape)
    array[...] = 0
    return array


class Memory:
    """Memory for arrays that are not needed at the same time: less of it stays in the cache.

    Parameters
    ----------
    dtype : dtype
    """

    def __init__(self, dtype: np.dtype):
        self._flat = aligned_empty((0,), dtype)

    def __call__(self, *shape: int) -> np.ndarray:
        """An array with any contents, as `zeros` otherwise."""
        width = int(np.prod(shape[1:]))
        size = shape[0] * (width + ROW_PADDING)
        if size > self._flat.size:
            self._flat = aligned_empty((size,), self._flat.dtype)
        rows = self._flat[:size].reshape(shape[0], width + ROW_PADDING)
        return rows[:, :width].reshape(shape)


def multiply_rows(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    """out = a · b or, for each s, out[s] = a[s] · b[s], in groups of rows of a.

    a is (…, R, M), b is (…, M, N), possibly a transposed view, and out is (…, R, N). The groups of
    one s follow one another, while b[s] is in the cache.
    """
    inner, columns = b.shape[-2:]
    rows = MAX_UNPACKED // max(inner * columns, 1)
    if b.strides[-1] != b.itemsize:
        rows = min(rows, MAX_UNPACKED_TRANSPOSED // max(columns, 1))
    grouped = 0  # rows of a in complete groups
    if rows < a.shape[-2]:
        rows = min(rows, ROWS) // 8 * 8 or max(rows, 1)
        grouped = a.shape[-2] // rows * rows
        groups = *a.shape[:-2], grouped // rows, rows
        a_groups = a[..., :grouped, :].reshape(*groups, inner)
        out_groups = out[..., :grouped, :].reshape(*groups, columns)
        np.matmul(a_groups, b[..., None, :, :], out=out_groups)
    if grouped < a.shape[-2]:
        np.matmul(a[..., grouped:, :], b, out=out[..., grouped:, :])


def multiply_columns(a: np.ndarray, b: np.ndarray, out: np.ndarray) -> None:
    """out[j] = a · b[j] for one constant matrix a, in groups of columns of each b[j].

    a is (M, K), b is (J, K, W), and out is (J, M, W).
    """
    width = b.shape[-1]
    at_once = min(COLUMNS, max(MAX_UNPACKED // max(a.size, 1) // 16 * 16, 16))
    grouped = width // at_once * at_once
    if grouped:
        pieces = _by_columns(out[..., :grouped], at_once)
        np.matmul(a, _by_columns(b[..., :grouped], at_once), out=pieces)
    if grouped < width:
        np.matmul(a, b[..., grouped:], out=out[..., grouped:])


def _by_columns(array: np.ndarray, at_once: int) -> np.ndarray:
    """(J, K, W) as (J, W / at_once, K, at_once), the same memory."""
    count, rows, width = array.shape
    return array.reshape(count, rows, width // at_once, at_once).transpose(0, 2, 1, 3)
