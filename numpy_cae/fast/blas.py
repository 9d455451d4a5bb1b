"""Read and set the number of threads of the OpenBLAS library that NumPy's wheels contain.

Two Python threads that each start two BLAS threads on two cores are slower than one, so a team sets
BLAS to one thread while it works. NumPy has no function for that; calling OpenBLAS takes a few
lines of ctypes (the package `threadpoolctl` does the same for every BLAS, and would be one more
dependency for one function). Where NumPy uses another BLAS, `blas_threads` is None and a team has
one thread.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path

import numpy as np

FUNCTION_NAMES = ("scipy_openblas_{}64_", "scipy_openblas_{}", "openblas_{}64_", "openblas_{}")
"""Names of these functions in NumPy's wheels, newest first."""


@lru_cache(maxsize=1)
def _openblas():
    """The functions that read and set the number of threads; None where they are not found."""
    package = Path(np.__file__).parent
    folders = (package.parent / "numpy.libs", package / ".libs", package / ".dylibs")
    for path in (path for folder in folders for path in sorted(folder.glob("*openblas*"))):
        try:
            library = ctypes.CDLL(str(path))
        except OSError:
            continue
        for name in FUNCTION_NAMES:
            read = getattr(library, name.format("get_num_threads"), None)
            write = getattr(library, name.format("set_num_threads"), None)
            if read is not None and write is not None:
                read.restype, write.argtypes, write.restype = ctypes.c_int, [ctypes.c_int], None
                return read, write
    return None


def blas_threads() -> int | None:
    """The number of threads of a matrix product, None if unknown (see OPENBLAS_NUM_THREADS)."""
    functions = _openblas()
    return None if functions is None else functions[0]()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Matrix products in the `with` block use the calling thread only."""
    functions = _openblas()
    if functions is None:
        yield
        return
    read, write = functions
    before = read()
    write(1)
    try:
        yield
    finally:
        write(before)
