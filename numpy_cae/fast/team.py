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
from functools import lru_cache
from queue import SimpleQueue

from numpy_cae.fast.blas import blas_threads, one_blas_thread


class Abandoned(RuntimeError):
    """Another member has failed, so there is nothing to wait for."""


class Team:
    """So many threads, the caller's own among them as number 0.

    Attributes
    ----------
    size : int
    """

    def __init__(self, size: int):
        self.size = size
        self._lock = threading.RLock()
        self._jobs = [SimpleQueue() for _ in range(size)]
        self._done: SimpleQueue = SimpleQueue()
        self._forget_arrivals()
        for member in range(1, size):
            threading.Thread(
                target=self._serve, args=(member,), name=f"numpy_cae {member}", daemon=True
            ).start()

    def run(self, work: Callable[[int], None]) -> None:
        """work(0), work(1), … side by side, each with one BLAS thread; back when all are done.

        Raises
        ------
        whatever the first member to fail has raised
        """
        with self._lock:
            if self.size == 1:
                work(0)
                return
            with one_blas_thread():
                for member in range(1, self.size):
                    # With the caller's context, which holds what it said about NumPy's warnings.
                    context = contextvars.copy_context()
                    self._jobs[member].put((context, work))
                failures = [self._guarded(work, 0)]
                failures += [self._done.get() for _ in range(1, self.size)]
            failures = [failure for failure in failures if failure is not None]
            if failures:
                self._forget_arrivals()
                raise next(each for each in failures if not isinstance(each, Abandoned))

    def wait(self, member: int) -> None:
        """Called by every member: wait until all of them have come to this line.

        Each tells each of the others, and hears from each. (`threading.Barrier` does the same in
        three times as long, which a single window would feel.)
        """
        others = [other for other in range(self.size) if other != member]
        for other in others:
            self._arrivals[member][other].put(True)
        for other in others:
            if not self._arrivals[other][member].get():
                raise Abandoned

    def _serve(self, member: int) -> None:
        """The life of a thread: one job after the other."""
        while True:
            context, work = self._jobs[member].get()
            self._done.put(context.run(self._guarded, work, member))
            del context, work

    def _guarded(self, work: Callable[[int], None], member: int) -> BaseException | None:
        """Run; on failure set the others free, who would wait for ever."""
        try:
            work(member)
        except BaseException as failure:
            for arrivals in self._arrivals[member]:
                arrivals.put(False)
            return failure
        return None

    def _forget_arrivals(self) -> None:
        self._arrivals = [[SimpleQueue() for _ in range(self.size)] for _ in range(self.size)]


@lru_cache
def team(size: int | None = None) -> Team:
    """The team of this process of that size: by default as many as BLAS would use threads."""
    return Team(size or blas_threads() or 1)


def share(total: int, member: int, size: int) -> slice:
    """The part of `total` things that falls to a member, as even as can be."""
    return slice(total * member // size, total * (member + 1) // size)


if hasattr(os, "register_at_fork"):  # a forked process inherits no threads
    os.register_at_fork(after_in_child=team.cache_clear)
