"""Python threads that do one job together.

NumPy releases the interpreter lock while it computes, so Python threads run in parallel. Every
worker runs the same function on one share of the data, in its own buffers; where a worker needs the
results of another, all workers `wait`. The same worker computes each number in the same order, so
a result depends on the number of threads and on nothing else.
"""

import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from contextvars import copy_context
from functools import lru_cache

from numpy_cae.fast.blas import blas_threads, one_blas_thread

Part = Callable[[int], slice]
"""Takes a number of items, and returns the thread's part of them."""


class ThreadTeam:
    """A number of threads; the calling thread is worker 0."""

    def __init__(self, size: int):
        self.size = size
        self._lock = threading.RLock()
        self._barrier = threading.Barrier(size)
        self._others = ThreadPoolExecutor(max(size - 1, 1), "numpy_cae")

    def run(self, work: Callable[[int], None], blas_threads: int = 1) -> None:
        """Call work(0), work(1), … in parallel and wait for all, each with one BLAS thread.

        With another number of `blas_threads`, BLAS uses as many as outside of a team. If a worker
        fails, the others are released and its error is raised.
        """
        with self._lock, one_blas_thread() if blas_threads == 1 else nullcontext():
            jobs = [  # in the caller's context, which holds its settings of NumPy's warnings
                self._others.submit(copy_context().run, self._guarded, work, worker)
                for worker in range(1, self.size)
            ]
            failures = [self._guarded(work, 0), *(job.result() for job in jobs)]
            self._barrier.reset()
            for failure in failures:
                if failure is not None and not isinstance(failure, threading.BrokenBarrierError):
                    raise failure

    def wait(self) -> None:
        """Wait until every worker has called this method."""
        self._barrier.wait()

    def _guarded(self, work: Callable[[int], None], worker: int) -> BaseException | None:
        """Run; on failure release the others, which would wait forever."""
        try:
            work(worker)
        except BaseException as failure:
            self._barrier.abort()
            return failure
        return None


@lru_cache
def thread_team(size: int | None = None) -> ThreadTeam:
    """This process's team of that size, by default the number of threads that BLAS would use."""
    return ThreadTeam(size or blas_threads() or 1)


def share(total: int, worker: int, workers: int) -> slice:
    """The worker's part of `total` items; parts differ by one item at most."""
    return slice(total * worker // workers, total * (worker + 1) // workers)


if hasattr(os, "register_at_fork"):  # a forked process inherits no threads
    os.register_at_fork(after_in_child=thread_team.cache_clear)
