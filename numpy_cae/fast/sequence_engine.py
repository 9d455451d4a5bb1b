"""`SequentialAutoencoder` with both GRUs on a team of threads, each with its part of the clips."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from numpy_cae.fast.fast_gru import FastGru
from numpy_cae.fast.gru_matrices import gru_matrices
from numpy_cae.fast.thread_team import share, thread_team
from numpy_cae.models.sequential_autoencoder import SequentialAutoencoder, Weights
from numpy_cae.ops.shapes import Pullback

MIN_STATES_PER_THREAD = 2048
"""A thread has at least so many numbers of states. With fewer, one thread alone is faster: the
threads wait for the interpreter lock, and a product of 8 columns takes as long as one of 16."""

MAX_BUFFERS = 8
"""So many sizes of clips are kept with their buffers, for the encoder and the decoder."""


class SequenceEngine(SequentialAutoencoder):
    """The definition over `FastGru`, for one caller at a time.

    A pullback is valid until the next call. Without `training` none is.
    """

    def __init__(self, model: SequentialAutoencoder, threads: int | None):
        self.weights = model.weights
        self.burn_in = model.burn_in
        self.training = True
        self._threads = threads
        self._make = lru_cache(MAX_BUFFERS)(_make_grus)

    def _read(self, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        grus = self._grus("encoder", x, x.shape[1])
        h = np.concatenate(_run(grus, lambda gru: gru.read(x[gru.clips])))

        def pullback(dh: np.ndarray) -> Weights:
            return _sums(_run(grus, lambda gru: gru.read_pullback(dh[gru.clips])))

        return h, pullback

    def _write(self, h: np.ndarray, steps: int) -> tuple[Sequence[np.ndarray], Pullback]:
        grus = self._grus("decoder", h, steps)
        written = np.concatenate(_run(grus, lambda gru: gru.write(h[gru.clips])), axis=1)

        def pullback(d_written: Sequence[np.ndarray]) -> tuple[np.ndarray, Weights]:
            dy = np.stack(d_written)
            parts = _run(grus, lambda gru: gru.write_pullback(dy[:, gru.clips]))
            return np.concatenate([dh for dh, _ in parts]), _sums([each for _, each in parts])

        return written, pullback

    def _grus(self, name: str, x: np.ndarray, steps: int) -> list[FastGru]:
        """One GRU for each thread, from the last few that were used, with the present weights."""
        most = len(x) * self.hidden // MIN_STATES_PER_THREAD
        threads = max(1, min(thread_team(self._threads).size, most, len(x)))
        dtype = np.result_type(x, self.weights["state_w"])
        sizes = self.features, self.hidden, steps, dtype, self.training
        grus = self._make(name, len(x), threads, sizes)
        matrices = gru_matrices(self.weights, name)
        for gru in grus:
            gru.matrices = matrices
        return grus


def _make_grus(name: str, clips: int, threads: int, sizes: tuple[Any, ...]) -> list[FastGru]:
    return [FastGru(name, share(clips, number, threads), *sizes) for number in range(threads)]


def _run(grus: list[FastGru], work: Callable[[FastGru], Any]) -> list[Any]:
    """work(gru) for each, on as many threads."""
    results: list[Any] = [None] * len(grus)

    def run_thread(number: int) -> None:
        results[number] = work(grus[number])

    thread_team(len(grus)).run(run_thread)
    return results


def _sums(parts: list[Weights]) -> Weights:
    """The threads' gradients added up in their order; the first thread's arrays hold the sums."""
    for part in parts[1:]:
        for name, gradient in part.items():
            parts[0][name] += gradient
    return parts[0]
