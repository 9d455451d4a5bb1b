"""`SequentialAutoencoder` at speed: its definition with both GRUs on a team of
threads, each with its part of the clips.
"""

import threading
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from numpy_cae.fast.fast_gru import FastGru, gru_matrices
from numpy_cae.fast.thread_team import one_blas_thread, share, thread_team
from numpy_cae.models import Losses, SequentialAutoencoder, sequential_autoencoder
from numpy_cae.models.sequential_autoencoder import FRAMES, Weights
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
        sizes = (self.features, self.hidden, steps), dtype, self.training
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


MAX_CLIPS = 128
"""At most so many clips are computed at a time when no gradient is needed."""


class FastSequentialAutoencoder(SequentialAutoencoder):
    """The methods of a `SequentialAutoencoder` on its own weights.

    `encode_with_pullback` and `decode_with_pullback` are those of the definition.

    See `accelerate` for the parameters. `weights` is the model's own dict.
    """

    def __init__(self, model: SequentialAutoencoder, threads: int | None = None):
        self.weights = model.weights
        self.burn_in = model.burn_in
        self._model = model
        self._threads = threads
        self._engine = SequenceEngine(model, threads)
        self._lock = threading.Lock()  # several threads may call one model: one uses its buffers

    def __reduce__(self):
        return type(self), (self._model, self._threads)  # copies and pickles start without buffers

    def encode(self, x: np.ndarray) -> np.ndarray:
        """z of clips, as `SequentialAutoencoder.encode`."""
        sequential_autoencoder.require_clips("x", x, self.weights)
        return self._in_parts(self._engine.encode, x)

    def decode(self, z: np.ndarray, frames: int = FRAMES) -> np.ndarray:
        """Clips of z, as `SequentialAutoencoder.decode`."""
        sequential_autoencoder.require_latent(z, frames, self.weights)
        return self._in_parts(lambda part: self._engine.decode(part, frames), z)

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """The loss and its derivatives, as `SequentialAutoencoder.loss_and_gradients`."""
        with self._lock, one_blas_thread():
            self._engine.training = True
            return self._engine.loss_and_gradients(x, prior, directions, weight)

    def _in_parts(self, compute: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
        with self._lock, one_blas_thread():
            self._engine.training = False
            starts = range(0, max(len(x), 1), MAX_CLIPS)
            return np.concatenate([compute(x[start : start + MAX_CLIPS]) for start in starts])
