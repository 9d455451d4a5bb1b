"""`ConvAutoencoder` at speed: its definition, step for step, over a `Workspace`.

Each public method describes what one worker (a thread with its share of the windows) does, and
runs that on all workers.
"""

import threading
from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from numpy_cae.fast.thread_team import thread_team
from numpy_cae.fast.workspace import Worker, Workspace
from numpy_cae.models.conv_autoencoder import (
    ConvAutoencoder,
    Gradients,
    require_denoising_arguments,
    require_windows,
)
from numpy_cae.models.conv_layer import ConvLayer
from numpy_cae.ops.shapes import require_shape

MAX_FRAMES = 16 * 160
"""Frames that one workspace holds when no gradient is computed; longer input goes in parts. (With
four times as many the buffers no longer fit the cache, and a window takes a fifth longer.)"""

MIN_MULTIPLICATIONS = 10_000_000
"""Multiplications of a direct convolution below which threads cost more than they save."""

MAX_WORKSPACES = 4
"""Workspaces that are kept: training uses two batch sizes, since the last batch is smaller."""


class FastConvAutoencoder(ConvAutoencoder):
    """The methods of a `ConvAutoencoder` on its own layers.

    `decode_with_pullback` is that of the definition.

    See `accelerate` for the parameters. `layers` is the model's own list.
    """

    def __init__(self, model: ConvAutoencoder, threads: int | None = None):
        self.layers = model.layers
        self._model, self._threads = model, threads
        self._make_workspace = lru_cache(MAX_WORKSPACES)(Workspace)
        self._lock = threading.Lock()  # several threads may call one model: one uses its buffers

    def __reduce__(self):
        return type(self), (self._model, self._threads)  # copies and pickles start without buffers

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Y = Φ(X), as `ConvAutoencoder.encode`."""
        layers = self.layers
        require_windows("x", x, layers)
        hidden = x.shape[1] >> len(layers), layers[-1].b.size
        return self._computed(x, x.shape[1], hidden, _encode)

    def decode(self, y: np.ndarray) -> np.ndarray:
        """X̂ = Φ†(Y), unpooling evenly, as `ConvAutoencoder.decode`."""
        layers = self.layers
        require_shape("y", y, ("batch", "frames", layers[-1].b.size))
        frames = y.shape[1] << len(layers)

        def decoded(layers: Sequence[ConvLayer], worker: Worker, y: np.ndarray) -> np.ndarray:
            _place_windows(y[worker.windows], worker.top)
            return _decode(layers, worker)

        return self._computed(y, frames, (frames, layers[0].w.shape[1]), decoded)

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(X)), as `ConvAutoencoder.project`; the hidden units stay in the buffers."""
        require_windows("x", x, self.layers)

        def projected(layers: Sequence[ConvLayer], worker: Worker, x: np.ndarray) -> np.ndarray:
            _encode(layers, worker, x)
            return _decode(layers, worker)

        return self._computed(x, x.shape[1], x.shape[1:], projected)

    def loss_and_gradients(
        self,
        x: np.ndarray,
        corrupted: np.ndarray,
        alpha: float = 0.0,
        first: Sequence[np.ndarray] | None = None,
        layer: int | None = None,
    ) -> tuple[float, Gradients]:
        """Equation 3 and its derivatives, as `ConvAutoencoder.loss_and_gradients`."""
        layers = self.layers if layer is None else [self.layers[layer]]
        require_denoising_arguments(layers, x, corrupted, first)
        batch, frames, _ = x.shape
        dtype = _dtype(layers, x, corrupted)
        dws = [np.empty(each.w.shape, dtype) for each in layers]

        def work(worker: Worker) -> None:
            _encode(layers, worker, corrupted)
            decoded = _decode(layers, worker, _masks(worker, first, len(layers)))
            worker.loss = _error(worker, decoded, x)
            _decode_pullback(worker)
            worker.loss += _sparsity(worker, alpha, batch)
            _encode_pullback(worker)

        with self._lock:
            workspace = self._workspace(layers, batch, frames, dtype, first, True)
            workspace.run(layers, work, dws=dws)
            workers = workspace.workers
            dbs = [np.sum([worker.db[k] for worker in workers], axis=0) for k in range(len(layers))]
            loss = sum(worker.loss for worker in workers)
        return loss, list(zip(dws, dbs, strict=True))

    def _computed(
        self, x: np.ndarray, frames: int, shape: tuple[int, ...], compute: Callable
    ) -> np.ndarray:
        """compute(layers, worker, part) of x, (B, *shape), in parts that bound the memory.

        It returns rows of frames, (T, B·C); `frames` are those of motion.
        """
        layers = self.layers
        out = np.empty((len(x), *shape), _dtype(layers, x))
        windows = max(1, MAX_FRAMES // max(frames, 1))
        last = None
        with self._lock:
            for start in range(0, len(x) if frames else 0, windows):
                given, taken = x[start : start + windows], out[start : start + windows]

                def work(worker: Worker, given=given, taken=taken) -> None:
                    _copy_windows(compute(layers, worker, given), taken[worker.windows])

                workspace = self._workspace(layers, len(given), frames, out.dtype, None, False)
                workspace.run(layers, work, workspace is last)
                last = workspace
        return out

    def _workspace(
        self,
        layers: Sequence[ConvLayer],
        batch: int,
        frames: int,
        dtype: np.dtype,
        first: Sequence[np.ndarray | None] | None,
        training: bool,
    ) -> Workspace:
        """The buffers for arguments of these sizes, from the last few that were used."""
        shapes = tuple((layer.w.shape, layer.bound) for layer in layers)
        unpooled_evenly = tuple(mask is None for mask in first or [None] * len(layers))
        work = sum(batch * (frames >> k) * layer.w.size for k, layer in enumerate(layers))
        team = thread_team(1 if work < MIN_MULTIPLICATIONS else self._threads)
        return self._make_workspace(shapes, batch, frames, dtype, unpooled_evenly, team, training)


def _dtype(layers: Sequence[ConvLayer], *arrays: np.ndarray) -> np.dtype:
    return np.result_type(*arrays, *(layer.w for layer in layers))


def _encode(layers: Sequence[ConvLayer], worker: Worker, x: np.ndarray) -> np.ndarray:
    """Φ of the worker's windows, `worker.top`."""
    _place_windows(x[worker.windows], worker.layers[0].convolution.x)
    for fast, layer in zip(worker.layers, layers, strict=True):
        fast.encode(layer.b)
    return worker.top


def _decode(
    layers: Sequence[ConvLayer], worker: Worker, masks: Sequence[np.ndarray | None] | None = None
) -> np.ndarray:
    """Φ† of `worker.top`, (T, B·C); without masks it unpools evenly."""
    decoded, masks = worker.top, masks or [None] * len(layers)
    for fast, layer, mask in reversed(list(zip(worker.layers, layers, masks, strict=True))):
        decoded = fast.decode(decoded, layer.b, mask)
    return decoded


def _decode_pullback(worker: Worker) -> None:
    """From dx̂ of the lowest layer to d_top; each layer's dy is the dx̂ of the one above."""
    targets = [fast.convolution.error for fast in worker.layers[1:]] + [worker.d_top]
    for fast, db, target in zip(worker.layers, worker.db, targets, strict=True):
        fast.decode_pullback(db, target)


def _encode_pullback(worker: Worker) -> None:
    """From d_top to the filters. The lowest layer's input is data: its gradient is not computed."""
    d = worker.d_top
    for k in reversed(range(len(worker.layers))):
        dx = worker.layers[k].encode_pullback(d, worker.db[k], with_dx=k > 0)
        if dx is not None:
            d = dx


def _place_windows(x: np.ndarray, rows: np.ndarray) -> None:
    """(B, T, C) into (T, B·C), or with more than C channels in a row."""
    batch, frames, channels = x.shape
    rows.reshape(frames, batch, -1)[..., :channels] = x.transpose(1, 0, 2)


def _copy_windows(rows: np.ndarray, x: np.ndarray) -> None:
    """(T, B·C), or with more than C channels in a row, into (B, T, C)."""
    batch, frames, channels = x.shape
    x[...] = rows.reshape(frames, batch, -1)[..., :channels].transpose(1, 0, 2)


def _masks(
    worker: Worker, first: Sequence[np.ndarray | None] | None, layers: int
) -> list[np.ndarray | None]:
    """The worker's part of each mask, as rows of frames."""
    parts: list[np.ndarray | None] = [None] * layers
    for k, mask in enumerate(first or ()):
        if mask is not None:
            rows = mask[worker.windows].transpose(1, 0, 2)
            parts[k] = rows.reshape(len(rows), -1)
    return parts


def _error(worker: Worker, decoded: np.ndarray, x: np.ndarray) -> float:
    """The worker's part of the mean squared error; puts dx̂ = 2 (x̂ - x) / N where it is used.

    `decoded` is overwritten.
    """
    error = worker.layers[0].convolution.error
    batch, frames, channels = x[worker.windows].shape
    target = x[worker.windows].transpose(1, 0, 2)
    x_hat, out = (rows.reshape(frames, batch, -1)[..., :channels] for rows in (decoded, error))
    np.subtract(x_hat, target, out=out)
    loss = float(np.multiply(error, error, out=decoded).sum()) / x.size
    error *= 2 / x.size
    return loss


def _sparsity(worker: Worker, alpha: float, batch: int) -> float:
    """The worker's part of α mean(|y|); adds its gradient, α sign(y) / N, to dy."""
    if alpha == 0:
        return 0.0
    y = worker.top
    windows = worker.windows.stop - worker.windows.start
    weight = alpha / (y.size // windows * batch)
    worker.d_top += weight * np.sign(y)
    return weight * float(np.abs(y).sum())
