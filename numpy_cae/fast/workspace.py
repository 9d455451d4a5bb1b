"""Everything that a step needs, allocated once: the layers of each thread, and the filters.

The threads divide the windows of a batch. They have the convolution of a layer in common: each
transforms some rows of ŵ, and computes a part of dw when all windows have been pulled back. A
worker takes one thread's windows through all layers and back.

A layer computes equations 1 and 2 in fixed buffers with time as the leading axis. The mathematics
is that of `numpy_cae.models.conv_layer`, line for line, with three differences: every array is
allocated once; the biases are added after pooling (max(u + b, v + b) = max(u, v) + b); and even
unpooling is part of the convolution below it, so that b is subtracted once for each pair of equal
frames. In float32 tanh⁻¹ is rounded to 1e-7 of 1, not of the result.
"""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from numpy_cae.fast.blocks import LayerSizes
from numpy_cae.fast.layer_convolution import (
    Convolution,
    DirectConvolution,
    SpectralConvolution,
    ThreadMemory,
)
from numpy_cae.fast.products import Memory, zeros
from numpy_cae.fast.thread_team import ThreadTeam, share, thread_team
from numpy_cae.models.conv_layer import ConvLayer

DIRECT_FRAMES = {"training": 120, "encoding": 50}
"""One window of at most this many frames for each thread of BLAS is convolved as defined: the
spectra of the filters would take longer than the products that they save. Measured on one machine,
where twice as many frames take about the same time."""

Layers = Sequence[ConvLayer]


class FastLayer:
    """One layer in both directions, with both pullbacks, for the windows of one thread.

    Parameters
    ----------
    convolution : Convolution
        Of this layer, the same for all threads.
    windows : slice
        The windows of this thread, b of them.
    memory : ThreadMemory
        The same for all layers of the thread.
    bound : float
        Where arctanh clips.
    y : (T/2, b, D) array
        Receives what the layer encodes: the input of the layer above.

    Attributes
    ----------
    x, d_decoded : (T, b, C) arrays
        The input, and the gradient for what the layer decodes; the caller writes both.
    db : (D,) array
        The bias's gradient for the windows of this thread.
    """

    def __init__(
        self,
        convolution: Convolution,
        windows: slice,
        memory: ThreadMemory,
        bound: float,
        y: np.ndarray,
    ):
        batch = windows.stop - windows.start
        self._convolution = convolution
        self._windows = windows
        self._memory = memory
        self.bound = bound
        self.x, self._x_frames = convolution.new_inputs(batch)
        self.d_decoded, self._d_decoded_frames = convolution.new_inputs(batch)
        outputs = convolution.new_outputs(batch, decodes=False)
        self._d_convolved, self._d_convolved_frames = outputs
        self._z, self._z_frames = convolution.new_outputs(batch, decodes=True)
        self._y = y
        self._b = np.zeros(y.shape[2], y.dtype)
        self.db = np.zeros_like(self._b)
        self._clipped = zeros(y.shape, y.dtype)
        self._scratch = zeros(y.shape, y.dtype)
        self._earlier_won = np.empty(y.shape, bool)
        self._inside = np.empty(y.shape, bool)
        self._first: np.ndarray | None = None

    def set_bias(self, b: np.ndarray) -> None:
        """Use b (D,), which is not copied."""
        self._b = b

    def encode(self) -> None:
        """y = tanh(max(pairs of x * W) + b), equation 1."""
        convolved = self._forwards(self._x_frames, decodes=False)
        earlier = convolved[0::2]
        later = convolved[1::2]
        np.greater_equal(earlier, later, out=self._earlier_won)
        y = np.maximum(earlier, later, out=self._y)
        y += self._b
        np.tanh(y, out=y)

    def decode(self, y: np.ndarray, first: np.ndarray | None) -> np.ndarray:
        """(Ψ†(tanh⁻¹(y)) - b) * W̃, equation 2: (T, B, C).

        `first`, (B, T/2, D), is the mask of `ops.unpool_random`.
        """
        np.clip(y, -self.bound, self.bound, out=self._clipped)
        np.equal(y, self._clipped, out=self._inside)
        z = self._z
        # tanh⁻¹(y) = log((1 + y) / (1 - y)) / 2: np.arctanh takes ten times as long.
        activated = np.add(1, self._clipped, out=self._scratch)
        activated /= np.subtract(1, self._clipped, out=z if first is None else z[0::2])
        np.log(activated, out=activated)
        activated *= 0.5
        if first is None:  # one row of z is both frames of a pair
            self._first = None
            np.multiply(activated, 0.5, out=z)
        else:
            self._first = np.ascontiguousarray(first.transpose(1, 0, 2))
            np.multiply(activated, self._first, out=z[0::2])
            np.subtract(activated, z[0::2], out=z[1::2])
        z -= self._b
        return self._backwards(self._z_frames, decodes=True)

    def decode_pullback(self, dy: np.ndarray) -> None:
        """From dx̂ in `d_decoded` to dy; db gets the decoder's share."""
        dz = self._forwards(self._d_decoded_frames, decodes=True)
        d_activated = self._scratch
        if self._first is None:  # dz is the sum for both frames of a pair
            np.multiply(dz, 0.5, out=d_activated)
        else:
            np.subtract(dz[0::2], dz[1::2], out=d_activated)
            d_activated *= self._first
            d_activated += dz[1::2]
        np.negative(dz.sum(axis=(0, 1)), out=self.db)
        # d arctanh = 1 / (1 - y²) inside the bound, 0 beyond
        slope = np.multiply(self._clipped, self._clipped, out=self._clipped)
        np.subtract(1, slope, out=slope)
        d_activated *= self._inside
        np.divide(d_activated, slope, out=dy)

    def encode_pullback(self, dy: np.ndarray, with_dx: bool) -> np.ndarray | None:
        """From dy, which is overwritten, to dx if it is wanted; adds the encoder's share to db."""
        slope = np.multiply(self._y, self._y, out=self._scratch)
        np.subtract(1, slope, out=slope)
        dy *= slope
        self.db += dy.sum(axis=(0, 1))
        d_convolved = self._d_convolved
        np.multiply(dy, self._earlier_won, out=d_convolved[0::2])
        np.subtract(dy, d_convolved[0::2], out=d_convolved[1::2])
        if with_dx:
            return self._backwards(self._d_convolved_frames, decodes=False)
        self._convolution.transform_outputs(self._d_convolved_frames, self._windows, decodes=False)
        return None

    def _forwards(self, inputs: np.ndarray, decodes: bool) -> np.ndarray:
        return self._convolution.forwards(inputs, self._windows, decodes, self._memory)

    def _backwards(self, outputs: np.ndarray, decodes: bool) -> np.ndarray:
        return self._convolution.backwards(outputs, self._windows, decodes, self._memory)


class Worker:
    """One thread's `windows` of a batch of B, taken through all layers and back; b of them.

    Arguments and results are those of the thread's windows, in the order of the definition,
    (b, T, C); a result is valid until the next call.

    Attributes
    ----------
    layers : list of FastLayer
    loss : float
        The thread's part of the loss.
    """

    def __init__(
        self, windows: slice, convolutions: Sequence[Convolution], bounds: Sequence[float]
    ):
        self.windows = windows
        sizes = convolutions[-1].sizes
        batch = windows.stop - windows.start
        self._top = zeros((sizes.frames // 2, batch, sizes.filters), sizes.dtype)
        memory = Memory(sizes.dtype), Memory(sizes.dtype)
        self.layers: list[FastLayer] = []
        output = self._top
        for convolution, bound in zip(reversed(convolutions), reversed(bounds), strict=True):
            layer = FastLayer(convolution, windows, memory, bound, output)
            self.layers.insert(0, layer)
            output = layer.x  # the layer below writes what this one reads
        self.loss = 0.0
        self._batch = sizes.batch
        self._d_top = zeros(self._top.shape, sizes.dtype)
        self._y = self._top.transpose(1, 0, 2)

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Φ(x), (b, t, D)."""
        self.layers[0].x[...] = x.transpose(1, 0, 2)
        for layer in self.layers:
            layer.encode()
        return self._y

    def decode(self, y: np.ndarray) -> np.ndarray:
        """Φ†(y), (b, T, C), unpooling evenly."""
        self._y[...] = y
        return self._decode([None] * len(self.layers)).transpose(1, 0, 2)

    def project(self, x: np.ndarray) -> np.ndarray:
        """Φ†(Φ(x))."""
        self.encode(x)
        return self._decode([None] * len(self.layers)).transpose(1, 0, 2)

    def pull_back(
        self, x: np.ndarray, corrupted: np.ndarray, alpha: float, first: Sequence[np.ndarray | None]
    ) -> None:
        """`loss` of equation 3, whose means are over the whole batch, and its derivatives.

        Those for the filters are not computed, but all that they are computed from.
        """
        self.encode(corrupted)
        decoded = self._decode(first)
        error = self.layers[0].d_decoded
        np.subtract(decoded, x.transpose(1, 0, 2), out=error)
        elements = self._batch * x[0].size
        self.loss = float(np.multiply(error, error, out=decoded).sum()) / elements
        error *= 2 / elements

        d_above = [layer.d_decoded for layer in self.layers[1:]] + [self._d_top]
        for layer, dy in zip(self.layers, d_above, strict=True):  # dy is dx̂ of the layer above
            layer.decode_pullback(dy)
        if alpha:
            weight = alpha / (self._batch * self._y[0].size)
            self.loss += weight * float(np.abs(self._top).sum())
            self._d_top += weight * np.sign(self._top)
        d: np.ndarray | None = self._d_top
        for layer in reversed(self.layers):
            if d is not None:
                d = layer.encode_pullback(d, with_dx=layer is not self.layers[0])

    def _decode(self, first: Sequence[np.ndarray | None]) -> np.ndarray:
        """Φ† of the hidden units, (T, b, C)."""
        decoded = self._top
        for layer, mask in zip(reversed(self.layers), reversed(first), strict=True):
            decoded = layer.decode(decoded, mask)
        return decoded


class Workspace:
    """The workers of a team, at most one a thread, for one size of batch and window.

    For one window there is one worker, and BLAS shares a product between its threads.

    Parameters
    ----------
    sizes : tuple of LayerSizes, one for each layer
    bounds : tuple of float
        Where arctanh clips.
    team : ThreadTeam
    """

    def __init__(self, sizes: Sequence[LayerSizes], bounds: Sequence[float], team: ThreadTeam):
        batch = sizes[0].batch
        sharing = min(team.size, batch)
        self.team = team if sharing > 1 else thread_team(1)
        self.blas_threads = team.size if batch == 1 else 1
        self.convolutions = [self._convolution(layer_sizes) for layer_sizes in sizes]
        parts = [share(batch, number, sharing) for number in range(sharing)]
        self.workers = [Worker(part, self.convolutions, bounds) for part in parts]

    def _convolution(self, sizes: LayerSizes) -> Convolution:
        """The convolution of a layer in the form that is faster."""
        purpose = "training" if sizes.training else "encoding"
        longest = DIRECT_FRAMES[purpose] * self.blas_threads
        if sizes.batch == 1 and sizes.frames <= longest:
            return DirectConvolution(sizes)
        return SpectralConvolution(sizes)

    def run(
        self, layers: Layers, work: Callable[[Worker], None], dws: Sequence[np.ndarray] = ()
    ) -> None:
        """Call work(worker) for every worker, with the W of these layers; then compute `dws`."""
        for worker in self.workers:
            for fast_layer, layer in zip(worker.layers, layers, strict=True):
                fast_layer.set_bias(layer.b)
        changed: list[SpectralConvolution] = []
        for convolution, layer in zip(self.convolutions, layers, strict=True):
            must_transform = convolution.set_filters(layer.w)
            if must_transform and isinstance(convolution, SpectralConvolution):
                changed.append(convolution)
        self.team.run(partial(self._run_thread, changed, work, dws), self.blas_threads)
        for spectral in changed:
            spectral.remember_filters()

    def loss(self) -> float:
        """The loss of all windows, after `Worker.pull_back`."""
        return sum(worker.loss for worker in self.workers)

    def dbs(self) -> list[np.ndarray]:
        """The gradient of each layer's bias for all windows, after `Worker.pull_back`."""
        totals = [np.zeros_like(layer.db) for layer in self.workers[0].layers]
        for worker in self.workers:
            for total, layer in zip(totals, worker.layers, strict=True):
                total += layer.db
        return totals

    def _run_thread(
        self,
        changed: Sequence[SpectralConvolution],
        work: Callable[[Worker], None],
        dws: Sequence[np.ndarray],
        number: int,
    ) -> None:
        """The share of thread `number`: some rows of ŵ, some windows, some channels of dw."""
        threads = self.team.size
        for spectral in changed:
            spectral.transform_filters(share(spectral.products, number, threads))
        if changed:
            self.team.wait()
        if number < len(self.workers):
            work(self.workers[number])
        if dws:
            self.team.wait()
            for convolution, dw in zip(self.convolutions, dws, strict=True):
                convolution.gradient(dw, share(convolution.sizes.channels, number, threads))
