"""`ConvAutoencoder` at speed: its definition, step for step, over a `Workspace`.

Each public method runs a method of `Worker` on all workers, threads with their windows each.
"""

import threading
from collections.abc import Callable, Sequence
from functools import lru_cache, partial
from typing import Any

import numpy as np

from numpy_cae.fast.blocks import LayerSizes
from numpy_cae.fast.thread_team import is_limited_to_one_blas_thread, thread_team
from numpy_cae.fast.workspace import Layers, Worker, Workspace
from numpy_cae.models import ConvAutoencoder, conv_autoencoder
from numpy_cae.ops.shapes import require_shape

MAX_FRAMES = 16 * 160
"""A thread computes at most this many frames at a time when no gradient is needed. (With four times
as many the buffers no longer fit the cache, with half as many it waits for the filters: measured on
one machine.)"""

MIN_MULTIPLICATIONS = 10_000_000
"""Where a direct convolution has fewer multiplications, threads cost more than they save."""

MAX_WORKSPACES = 4
"""So many workspaces are kept: training uses two batch sizes, since the last batch is smaller."""


class FastConvAutoencoder(ConvAutoencoder):
    """The methods of a `ConvAutoencoder` on its own layers.

    `decode_with_pullback` is that of the definition.

    See `accelerate` for the parameters. `layers` is the model's own list.
    """

    def __init__(self, model: ConvAutoencoder, threads: int | None = None):
        self.layers = model.layers
        self._model = model
        self._threads = threads
        self._make_workspace = lru_cache(MAX_WORKSPACES)(Workspace)
        self._lock = threading.Lock()  # several threads may call one model: one uses its buffers

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._model, self._threads)  # copies and pickles start without buffers

    def encode(self, x: np.ndarray, layers: int | None = None) -> np.ndarray:
        """Y = Φ(X), as `ConvAutoencoder.encode`."""
        used = self.layers[:layers]
        conv_autoencoder.require_windows("x", x, used)
        hidden = x.shape[1] >> len(used), used[-1].b.size
        return self._compute_in_parts(Worker.encode, used, x, x.shape[1], hidden)

    def decode(self, y: np.ndarray) -> np.ndarray:
        """X̂ = Φ†(Y), unpooling evenly, as `ConvAutoencoder.decode`."""
        require_shape("y", y, ("batch", "frames", self.layers[-1].b.size))
        shape = y.shape[1] * self.stride, self.layers[0].w.shape[1]
        return self._compute_in_parts(Worker.decode, self.layers, y, shape[0], shape)

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X)), as `ConvAutoencoder.project`; the hidden units stay in the buffers."""
        conv_autoencoder.require_windows("x", x, self.layers)
        return self._compute_in_parts(Worker.project, self.layers, x, x.shape[1], x.shape[1:])

    def loss_and_gradients(
        self,
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float = 0.0,
        first: Sequence[np.ndarray] | None = None,
        layer: int | None = None,
    ) -> tuple[float, conv_autoencoder.Gradients]:
        """Equation 3 and its derivatives, as `ConvAutoencoder.loss_and_gradients`."""
        used = self.layers if layer is None else [self.layers[layer]]
        conv_autoencoder.require_denoising_arguments(used, x, corrupted, first)
        dtype = np.result_type(x, corrupted, *(conv_layer.w for conv_layer in used))
        dws = [np.empty(conv_layer.w.shape, dtype) for conv_layer in used]
        masks: list[np.ndarray | None] = [None] * len(used) if first is None else list(first)

        def pull_back(worker: Worker) -> None:
            part = worker.windows
            masks_of_part = [None if mask is None else mask[part] for mask in masks]
            worker.pull_back(x[part], corrupted[part], alpha, masks_of_part)

        with self._lock:
            rates = [2 if mask is None else 1 for mask in masks]
            workspace = self._workspace(used, len(x), x.shape[1], dtype, rates)
            workspace.run(used, pull_back, dws)
            return workspace.loss(), list(zip(dws, workspace.dbs(), strict=True))

    def _compute_in_parts(
        self,
        compute: Callable[[Worker, np.ndarray], np.ndarray],
        layers: Layers,
        x: np.ndarray,
        frames: int,
        shape: tuple[int, ...],
    ) -> np.ndarray:
        """`compute` of x by the workers, (B, *shape), in parts that bound the memory.

        `frames` are those of motion.
        """
        out = np.empty((len(x), *shape), np.result_type(x, *(layer.w for layer in layers)))
        windows = max(1, MAX_FRAMES * thread_team(self._threads).size // max(frames, 1))
        with self._lock:
            for start in range(0, len(x) if frames else 0, windows):
                part = slice(start, start + windows)
                work = partial(_compute_windows, compute, x[part], out[part])
                workspace = self._workspace(layers, len(x[part]), frames, out.dtype)
                workspace.run(layers, work)
        return out

    def _workspace(
        self, layers: Layers, batch: int, frames: int, dtype: np.dtype, rates: Sequence[int] = ()
    ) -> Workspace:
        """The buffers for arguments of these sizes, from the last few that were used.

        `rates` are given for training: the frames for a row of each decoding layer's input.
        """
        training = bool(rates)
        rates = rates or [2] * len(layers)
        sizes = tuple(
            LayerSizes(
                taps=layer.w.shape[0],
                channels=layer.w.shape[1],
                filters=layer.w.shape[2],
                batch=batch,
                frames=frames >> k,
                rate=rates[k],
                training=training,
                dtype=dtype,
            )
            for k, layer in enumerate(layers)
        )
        multiplications = sum(
            batch * (frames >> k) * layer.w.size for k, layer in enumerate(layers)
        )
        is_small = multiplications < MIN_MULTIPLICATIONS
        if is_small or (batch == 1 and is_limited_to_one_blas_thread()):
            team = thread_team(1)
        else:
            team = thread_team(self._threads)
        return self._make_workspace(sizes, tuple(layer.bound for layer in layers), team)


def _compute_windows(
    compute: Callable[[Worker, np.ndarray], np.ndarray],
    x: np.ndarray,
    out: np.ndarray,
    worker: Worker,
) -> None:
    """Write what a worker computes of its windows of x into those of `out`."""
    out[worker.windows] = compute(worker, x[worker.windows])
