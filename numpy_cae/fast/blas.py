"""Read and set the number of threads of the OpenBLAS library that NumPy's wheels contain.

Two Python threads that each start two BLAS threads on two cores are slower than one, so a team sets
BLAS to one thread while it works. NumPy has no function for that; calling OpenBLAS takes a few
lines of ctypes (the package `threadpoolctl` does the same for every BLAS, but is one more
dependency). If NumPy uses another BLAS, `blas_threads` returns None and a team has one thread.
"""

import ctypes
import threading
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
                read.restype = ctypes.c_int
                write.restype = None
                write.argtypes = [ctypes.c_int]
                return read, write
    return None


def blas_threads() -> int | None:
    """The number of threads of a matrix product outside of `one_blas_thread`, None if unknown.

    See OPENBLAS_NUM_THREADS.
    """
    functions = _openblas()
    if functions is None:
        return None
    return _threads_before[0] if _threads_before else functions[0]()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Let every matrix product of the process use one thread, until all such blocks have ended.

    Put a whole computation with a team into one block: after a product on two threads, the second
    thread of OpenBLAS waits actively for 20 ms and takes a core from the team.
    """
    functions = _openblas()
    if functions is None:
        yield
        return
    read, write = functions
    with _lock:
        _threads_before.append(_threads_before[-1] if _threads_before else read())
        write(1)
    try:
        yield
    finally:
        with _lock:
            before = _threads_before.pop()
            write(1 if _threads_before else before)


_lock = threading.Lock()
_threads_before: list[int] = []
"""The number of threads outside of the blocks, once for each block that has not ended."""
