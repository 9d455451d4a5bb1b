"""Python threads that do one job together.

NumPy releases the interpreter lock while it computes, so Python threads run in parallel. Every
worker runs the same function on one share of the data, in its own buffers; where a worker needs the
results of another, all workers `wait`. The same worker computes each number in the same order, so
a result depends on the number of threads and on nothing else.

**BLAS** is the OpenBLAS library that NumPy's wheels contain, and the other one that SciPy's wheels
contain: `one_blas_thread` sets their numbers of threads. Two Python threads that each start two
BLAS threads on two cores are slower than one, so a team sets BLAS to one thread while it works.
NumPy has no function for that; calling OpenBLAS takes a few lines of ctypes (the package
`threadpoolctl` does the same for every BLAS, but is one more dependency). If NumPy uses another
BLAS, `blas_threads` returns None, a team has one thread, and SciPy's is not changed either.
"""

import ctypes
import os
import threading
import weakref
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, nullcontext, suppress
from contextvars import ContextVar
from functools import lru_cache, partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

FUNCTION_NAMES = ("scipy_openblas_{}64_", "scipy_openblas_{}", "openblas_{}64_", "openblas_{}")
"""Names of these functions in the wheels of NumPy and SciPy, newest first."""


@lru_cache(maxsize=1)
def _openblas() -> list[tuple[Callable[[], int], Callable[[int], None]]]:
    """The functions that read and set the number of threads of NumPy's OpenBLAS, then those of
    SciPy's; none where NumPy's are not found."""
    of_numpy = _functions_of("numpy")
    return of_numpy + _functions_of("scipy") if of_numpy else []


def _functions_of(package: str) -> list[tuple[Callable[[], int], Callable[[int], None]]]:
    """Those of each OpenBLAS of a package."""
    functions = map(_thread_functions, _libraries(package))
    return [pair for pair in functions if pair is not None]


def _libraries(package: str) -> Iterator[ctypes.CDLL]:
    """The libraries that may be the OpenBLAS of a package, of those that can be loaded.

    The library is loaded, but the package is not imported: SciPy takes thirty times as long.
    """
    spec = find_spec(package)
    for place in (spec and spec.submodule_search_locations) or ():
        folder = Path(place)
        for libraries in (folder.parent / f"{package}.libs", folder / ".libs", folder / ".dylibs"):
            for path in sorted(libraries.glob("*openblas*")):
                with suppress(OSError):
                    yield ctypes.CDLL(str(path))


def blas_kernel() -> str:
    """The name of the kernels that OpenBLAS uses on this processor, such as "SkylakeX"; "unknown"
    for another BLAS."""
    for library in _libraries("numpy"):
        for name in FUNCTION_NAMES:
            read = getattr(library, name.format("get_corename"), None)
            if read is not None:
                read.restype = ctypes.c_char_p
                return read().decode()
    return "unknown"


def _thread_functions(
    library: ctypes.CDLL,
) -> tuple[Callable[[], int], Callable[[int], None]] | None:
    """The functions of a library that read and set its number of threads; None if it has none."""
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
    libraries = _openblas()
    if not libraries:
        return None
    if _open_blocks.threads_before is not None:
        return _open_blocks.threads_before[0]
    read, _ = libraries[0]
    return read()


class _Block:
    """A block of `one_blas_thread` that has not ended."""


class _OpenBlocks:
    """The blocks of `one_blas_thread` that have not ended, and the numbers of threads before them.

    Ctrl-C may come between any two steps here. So a block counts only as long as something refers
    to it, and the numbers of threads are forgotten after they were restored, not before: where an
    interrupt prevents the restoration, the next block that ends makes up for it.
    """

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.blocks: weakref.WeakSet[_Block] = weakref.WeakSet()
        self.threads_before: list[int] | None = None

    def add(self, block: _Block) -> None:
        with self.lock:
            if self.threads_before is None:
                self.threads_before = [read() for read, _ in _openblas()]
            self.blocks.add(block)
            for _, write in _openblas():
                write(1)

    def remove(self, block: _Block) -> None:
        with self.lock:
            self.blocks.discard(block)
            if not self.blocks and self.threads_before is not None:
                for (_, write), threads in zip(_openblas(), self.threads_before, strict=True):
                    write(threads)
                self.threads_before = None


_open_blocks = _OpenBlocks()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Let every matrix product of the process use one thread, until all such blocks have ended.

    Where NumPy has no OpenBLAS of its own nothing is changed.

    Put a whole computation with a team into one block: after a product on two threads, the second
    thread of OpenBLAS waits actively for 20 ms and takes a core from the team.
    """
    if not _openblas():
        yield
        return
    block = _Block()
    try:
        _open_blocks.add(block)
        yield
    finally:
        _open_blocks.remove(block)


def is_limited_to_one_blas_thread() -> bool:
    """Whether a block of `one_blas_thread` has not ended."""
    return _open_blocks.threads_before is not None


class ThreadTeam:
    """A number of threads; the calling thread is worker 0."""

    def __init__(self, size: int):
        self.size = size
        self._lock = threading.RLock()
        self._barrier = threading.Barrier(size)
        self._pool = ThreadPoolExecutor(max(size - 1, 1), "numpy_cae")

    def run(self, work: Callable[[int], Any], blas_threads: int = 1) -> list[Any]:
        """work(0), work(1), … in parallel, each with one BLAS thread; waits for all.

        With another number of `blas_threads`, BLAS uses as many as outside of a team. If a worker
        fails, the others are released and its error is raised.
        """
        with self._lock, one_blas_thread() if blas_threads == 1 else nullcontext():
            warnings: dict[str, Any] = {"call": np.geterrcall(), **np.geterr()}
            guarded = partial(self._run_guarded, work, warnings)
            jobs = [self._pool.submit(guarded, worker) for worker in range(1, self.size)]
            done = [guarded(0), *(job.result() for job in jobs)]
            self._barrier.reset()
        for _, failure in done:
            if failure is not None and not isinstance(failure, threading.BrokenBarrierError):
                raise failure
        return [result for result, _ in done]

    def wait(self) -> None:
        """Wait until every worker has called this method."""
        self._barrier.wait()

    def _run_guarded(
        self, work: Callable[[int], Any], warnings: dict[str, Any], worker: int
    ) -> tuple[Any, BaseException | None]:
        """The result, or the failure after releasing the others, which would wait forever.

        `warnings` are the caller's settings of NumPy's warnings, the arguments of `np.errstate`:
        a thread does not inherit them.
        """
        try:
            with np.errstate(**warnings):
                return work(worker), None
        except BaseException as failure:
            self._barrier.abort()
            return None, failure


_is_single: ContextVar[bool] = ContextVar("is_single", default=False)


@contextmanager
def one_thread() -> Iterator[None]:
    """Let every team have one thread, and BLAS as well: what is computed has the same bits on any
    number of processors."""
    token = _is_single.set(True)
    try:
        with one_blas_thread():
            yield
    finally:
        _is_single.reset(token)


def thread_team(size: int | None = None) -> ThreadTeam:
    """This process's team of that size, by default the number of threads that BLAS would use; in a
    block of `one_thread` that of one thread."""
    if _is_single.get():
        return _team(1)
    return _team(size or blas_threads() or 1)


@lru_cache
def _team(size: int) -> ThreadTeam:
    return ThreadTeam(size)


def share(total: int, worker: int, workers: int) -> slice:
    """The worker's part of `total` items; parts differ by one item at most."""
    return slice(total * worker // workers, total * (worker + 1) // workers)


if hasattr(os, "register_at_fork"):  # a forked process inherits no threads
    os.register_at_fork(after_in_child=_team.cache_clear)
