"""`SequentialAutoencoder` at speed: its definition over a `SequenceEngine`."""

import threading
from collections.abc import Callable

import numpy as np

from numpy_cae.fast.blas import one_blas_thread
from numpy_cae.fast.sequence_engine import SequenceEngine
from numpy_cae.models.sequential_autoencoder import (
    FRAMES,
    Losses,
    SequentialAutoencoder,
    Weights,
    require_clips,
    require_latent,
)

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
        require_clips("x", x, self.weights)
        return self._in_parts(self._engine.encode, x)

    def decode(self, z: np.ndarray, frames: int = FRAMES) -> np.ndarray:
        """Clips of z, as `SequentialAutoencoder.decode`."""
        require_latent(z, frames, self.weights)
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
