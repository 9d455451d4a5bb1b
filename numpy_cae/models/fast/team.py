"""Two Python threads that do one job in step.

NumPy lets go of the interpreter while it computes, so Python threads do run side by side. Every
member runs the same function on its own share and its own buffers; where one needs what another
has made, all of them `wait`. Each number is computed by the same member in the same order
however fast the threads are, so a result depends on the size of the team and on nothing else.
"""

from __future__ import annotations

import contextvars
import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

from numpy_cae.models.fast.blas import blas_threads, one_blas_thread


class Team:
    """So many threads, the caller's own among them.

    Attributes
    ----------
    size : int
    """

    def __init__(self, size: int):
        self.size = size
        self._barrier = threading.Barrier(size)
        self._lock = threading.RLock()
        self._others = ThreadPoolExecutor(size - 1, "numpy_cae") if size > 1 else None

    def run(self, work: Callable[[int], None]) -> None:
        """work(0), work(1), … side by side, each with one BLAS thread; back when all are done.

        Raises
        ------
        whatever the first member to fail has raised
        """
        if self.size == 1:
            with self._lock:
                work(0)
            return
        with self._lock, one_blas_thread():
            started = [
                # With the caller's context, which holds what it said about NumPy's warnings.
                self._others.submit(contextvars.copy_context().run, self._guarded, work, member)
                for member in range(1, self.size)
            ]
            failures = [self._guarded(work, 0), *(each.result() for each in started)]
        failures = [failure for failure in failures if failure is not None]
        if failures:
            self._barrier.reset()
            broken = threading.BrokenBarrierError
            raise next((each for each in failures if not isinstance(each, broken)), failures[0])

    def wait(self) -> None:
        """Wait until every member has come to this line."""
        if self.size > 1:
            self._barrier.wait()

    def _guarded(self, work: Callable[[int], None], member: int) -> BaseException | None:
        """Run; on failure set the others free, who would wait for ever."""
        try:
            work(member)
        except BaseException as failure:
            self._barrier.abort()
            return failure
        return None


@lru_cache
def team(size: int | None = None) -> Team:
    """The team of this process of that size: by default as many as BLAS would use threads."""
    return Team(size or blas_threads() or 1)


def share(total: int, member: int, size: int) -> slice:
    """The part of `total` things that falls to a member, as even as can be."""
    return slice(total * member // size, total * (member + 1) // size)


if hasattr(os, "register_at_fork"):  # a forked process inherits no threads
    os.register_at_fork(after_in_child=team.cache_clear)
