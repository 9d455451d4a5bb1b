"""Threads that work together, and the BLAS threads that they use."""

import pytest

from numpy_cae.fast.thread_team import _openblas, blas_threads, one_blas_thread, share, thread_team


def test_a_worker_that_fails_releases_the_others_and_raises_its_error():
    def work(worker):
        if worker == 1:
            raise KeyError("what went wrong")
        thread_team(2).wait()

    for _ in range(2):
        with pytest.raises(KeyError, match="what went wrong"):
            thread_team(2).run(work)
    assert thread_team(2).run(str) == ["0", "1"]


def test_the_number_of_blas_threads_comes_back():
    if _openblas() is None:
        pytest.skip("this NumPy does not bring its own OpenBLAS")
    number_now, set_number = _openblas()
    before = number_now()
    set_number(2)
    try:
        with one_blas_thread(), one_blas_thread():
            assert number_now() == 1
            assert blas_threads() == 2
        assert number_now() == 2
    finally:
        set_number(before)


def test_shares_cover_everything_once():
    parts = [share(11, worker, 3) for worker in range(3)]
    assert [n for part in parts for n in range(11)[part]] == list(range(11))
