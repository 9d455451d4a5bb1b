"""Threads that work together, and the BLAS threads that they use."""

import linecache
import sys
from itertools import count

import pytest

from numpy_cae.fast.thread_team import (
    _open_blocks,
    _openblas,
    blas_threads,
    one_blas_thread,
    one_thread,
    share,
    thread_team,
)


def test_a_worker_that_fails_releases_the_others_and_raises_its_error():
    def work(worker):
        if worker == 1:
            raise KeyError("what went wrong")
        thread_team(2).wait()

    for _ in range(2):
        with pytest.raises(KeyError, match="what went wrong"):
            thread_team(2).run(work)
    assert thread_team(2).run(str) == ["0", "1"]


def threads_of_libraries():
    return [read() for read, _ in _openblas()]


def set_threads(numbers):
    for (_, write), number in zip(_openblas(), numbers, strict=True):
        write(number)


def test_the_number_of_blas_threads_comes_back():
    if not _openblas():
        pytest.skip("this NumPy does not bring its own OpenBLAS")
    before = threads_of_libraries()
    two_or_three = [2, 3][: len(before)]  # NumPy's, and where SciPy has its own, SciPy's
    try:
        set_threads(two_or_three)
        with one_blas_thread(), one_blas_thread():
            assert set(threads_of_libraries()) == {1}
            assert blas_threads() == 2
        assert threads_of_libraries() == two_or_three
    finally:
        set_threads(before)


def test_shares_cover_everything_once():
    parts = [share(11, worker, 3) for worker in range(3)]
    assert [n for part in parts for n in range(11)[part]] == list(range(11))


def raise_at_step(last_step):
    """A trace function that interrupts the module before its so-many-th line.

    Python handles signals after calls and at the begin of functions, so never between a lock and
    its block: the end of a `with` counts as a line, but is no such place.
    """
    steps = count()

    def trace(frame, event, _):
        if not frame.f_code.co_filename.endswith("thread_team.py"):
            return None
        line = linecache.getline(frame.f_code.co_filename, frame.f_lineno)
        is_end_of_lock = "with self.lock" in line and _open_blocks.lock.locked()
        if event == "line" and not is_end_of_lock and next(steps) == last_step:
            raise KeyboardInterrupt
        return trace

    return trace


@pytest.mark.skipif(not _openblas(), reason="needs OpenBLAS")
def test_the_threads_come_back_after_an_interrupt_at_any_step():
    before = threads_of_libraries()
    two_or_three = [2, 3][: len(before)]
    traced = sys.gettrace()
    set_threads(two_or_three)
    interrupts = 0
    try:
        for step in range(80):
            try:
                sys.settrace(raise_at_step(step))
                with one_blas_thread():
                    pass
            except KeyboardInterrupt:
                interrupts += 1
            finally:
                sys.settrace(traced)
            with one_blas_thread():
                assert set(threads_of_libraries()) == {1}
            assert threads_of_libraries() == two_or_three, step
    finally:
        set_threads(before)
    assert 10 < interrupts < 80  # every step was interrupted


def test_every_team_of_a_block_with_one_thread_has_one_thread():
    with one_thread():
        assert thread_team(2).size == 1
    assert thread_team(2).size == 2
