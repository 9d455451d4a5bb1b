"""Python threads that do one job together.

NumPy releases the interpreter lock while it computes, so Python threads run in parallel. Every
worker runs the same function on one share of the data, in its own buffers; where a worker needs the
results of another, all workers `wait`. The same worker computes each number in the same order, so
a result depends on the number of threads and on nothing else.
"""

import contextvars
import os
import threading
from collections.abc import Callable
from functools import lru_cache
from queue import SimpleQueue

from numpy_cae.fast.blas import blas_threads, one_blas_thread


class OtherWorkerFailed(RuntimeError):
    """Another worker has failed, so there is nothing to wait for."""


class ThreadTeam:
    """A number of threads; the calling thread is worker 0."""

    def __init__(self, size: int):
        self.size = size
        self._lock = threading.RLock()
        self._jobs: list[SimpleQueue] = [SimpleQueue() for _ in range(size)]
        self._done: SimpleQueue = SimpleQueue()
        self._reset_arrivals()
        for worker in range(1, size):
            threading.Thread(
                target=self._serve, args=(worker,), name=f"numpy_cae {worker}", daemon=True
            ).start()

    def run(self, work: Callable[[int], None]) -> None:
        """Call work(0), work(1), … in parallel, each with one BLAS thread, and wait for all.

        If a worker fails, the others are released and its error is raised.
        """
        with self._lock, one_blas_thread():
            if self.size == 1:
                work(0)
                return
            for worker in range(1, self.size):
                # In the caller's context, which holds its settings of NumPy's warnings.
                context = contextvars.copy_context()
                self._jobs[worker].put((context, work))
            results = [self._guarded(work, 0)]
            results += [self._done.get() for _ in range(1, self.size)]
            failures = [failure for failure in results if failure is not None]
            if failures:
                self._reset_arrivals()
                raise next(each for each in failures if not isinstance(each, OtherWorkerFailed))

    def wait(self, worker: int) -> None:
        """Wait until every worker has called this method.

        Each worker sends a message to every other. (`threading.Barrier` takes three times as long,
        which is noticeable for a single window.)
        """
        others = [other for other in range(self.size) if other != worker]
        for other in others:
            self._arrivals[worker][other].put(True)
        for other in others:
            if not self._arrivals[other][worker].get():
                raise OtherWorkerFailed

    def _serve(self, worker: int) -> None:
        """The loop of a thread: one job after the other."""
        while True:
            context, work = self._jobs[worker].get()
            self._done.put(context.run(self._guarded, work, worker))
            del context, work

    def _guarded(self, work: Callable[[int], None], worker: int) -> BaseException | None:
        """Run; on failure release the others, which would wait forever."""
        try:
            work(worker)
        except BaseException as failure:
            for arrivals in self._arrivals[worker]:
                arrivals.put(False)
            return failure
        return None

    def _reset_arrivals(self) -> None:
        self._arrivals: list[list[SimpleQueue]] = [
            [SimpleQueue() for _ in range(self.size)] for _ in range(self.size)
        ]


@lru_cache
def thread_team(size: int | None = None) -> ThreadTeam:
    """This process's team of that size, by default the number of threads that BLAS would use."""
    return ThreadTeam(size or blas_threads() or 1)


def share(total: int, worker: int, workers: int) -> slice:
    """The worker's part of `total` items; parts differ by one item at most."""
    return slice(total * worker // workers, total * (worker + 1) // workers)


if hasattr(os, "register_at_fork"):  # a forked process inherits no threads
    os.register_at_fork(after_in_child=thread_team.cache_clear)
