"""`ConvAutoencoder` at speed: its definition, step for step, over a `Workspace`.

Each public method runs a method of `Worker` on all workers, threads with their windows each.
"""

import threading
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from numpy_cae.fast.blocks import LayerSizes
from numpy_cae.fast.thread_team import thread_team
from numpy_cae.fast.workspace import Layers, Worker, Workspace
from numpy_cae.models import ConvAutoencoder, conv_autoencoder
from numpy_cae.ops.shapes import require_shape

MAX_FRAMES = 16 * 160
"""A thread computes at most this many frames at a time when no gradient is needed. (With four times
as many the buffers no longer fit the cache, with half as many it waits for the filters.)"""

MIN_MULTIPLICATIONS = 10_000_000
"""Where a direct convolution has fewer multiplications, threads cost more than they save."""

MAX_WORKSPACES = 4
"""So many are kept: training uses two batch sizes, since the last batch is smaller."""


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

    def __reduce__(self):
        return type(self), (self._model, self._threads)  # copies and pickles start without buffers

    def encode(self, x: np.ndarray, layers: int | None = None) -> np.ndarray:
        """Y = Φ(X), as `ConvAutoencoder.encode`."""
        used = self.layers[:layers]
        conv_autoencoder.require_windows("x", x, used)
        hidden = x.shape[1] >> len(used), used[-1].b.size
        return self._computed(Worker.encode, used, x, x.shape[1], hidden)

    def decode(self, y: np.ndarray) -> np.ndarray:
        """X̂ = Φ†(Y), unpooling evenly, as `ConvAutoencoder.decode`."""
        require_shape("y", y, ("batch", "frames", self.layers[-1].b.size))
        shape = y.shape[1] * self.stride, self.layers[0].w.shape[1]
        return self._computed(Worker.decode, self.layers, y, shape[0], shape)

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X)), as `ConvAutoencoder.project`; the hidden units stay in the buffers."""
        conv_autoencoder.require_windows("x", x, self.layers)
        return self._computed(Worker.project, self.layers, x, x.shape[1], x.shape[1:])

    def loss_and_gradients(
        self,
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float = 0.0,
        first: Sequence[np.ndarray] | None = None,
        layer: int | None = None,
    ) -> tuple[float, conv_autoencoder.Gradients]:
        """Equation 3 and its derivatives, as `ConvAutoencoder.loss_and_gradients`."""
        layers = self.layers if layer is None else [self.layers[layer]]
        conv_autoencoder.require_denoising_arguments(layers, x, corrupted, first)
        dtype = np.result_type(x, corrupted, *(each.w for each in layers))
        dws = [np.empty(each.w.shape, dtype) for each in layers]
        masks = [None] * len(layers) if first is None else first

        def work(worker: Worker) -> None:
            part = worker.windows
            of_thread = [None if mask is None else mask[part] for mask in masks]
            worker.pull_back(x[part], corrupted[part], alpha, of_thread)

        with self._lock:
            rates = [2 if mask is None else 1 for mask in masks]
            workspace = self._workspace(layers, *x.shape[:2], dtype, rates)
            workspace.run(layers, work, dws)
            workers = workspace.workers
            loss = sum(worker.loss for worker in workers)
            dbs = [sum(each.layers[k].db for each in workers) for k in range(len(layers))]
        return loss, list(zip(dws, dbs, strict=True))

    def _computed(
        self,
        compute: Callable[[Worker, np.ndarray], np.ndarray],
        layers: Layers,
        x: np.ndarray,
        frames: int,
        shape: tuple[int, ...],
    ) -> np.ndarray:
        """What workers compute of x, (B, *shape), in parts that bound the memory.

        `frames` are those of motion.
        """
        out = np.empty((len(x), *shape), np.result_type(x, *(each.w for each in layers)))
        windows = max(1, MAX_FRAMES * thread_team(self._threads).size // max(frames, 1))
        with self._lock:
            for start in range(0, len(x) if frames else 0, windows):
                given = x[start : start + windows]
                taken = out[start : start + windows]

                def work(worker: Worker, given=given, taken=taken) -> None:
                    taken[worker.windows] = compute(worker, given[worker.windows])

                self._workspace(layers, len(given), frames, out.dtype).run(layers, work)
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
            LayerSizes(*layer.w.shape, batch, frames >> k, rates[k], training, dtype)
            for k, layer in enumerate(layers)
        )
        work = sum(batch * (frames >> k) * layer.w.size for k, layer in enumerate(layers))
        team = thread_team(1 if work < MIN_MULTIPLICATIONS else self._threads)
        return self._make_workspace(sizes, tuple(layer.bound for layer in layers), team)
