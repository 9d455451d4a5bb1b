"""Everything that a step needs, allocated once: the layers of each thread, and what they share.

The threads divide the windows of a batch. They have the filters in common: each transforms some
rows of ŵ, and computes a part of dw when all windows have been pulled back.
A worker takes one thread's windows through all layers and back.

A layer computes equations 1 and 2 in fixed buffers with time as the leading axis. The mathematics
is that of `numpy_cae.models.conv_layer`, line for line, with three differences: every array is
allocated once; the biases are added after pooling (max(u + b, v + b) = max(u, v) + b); and even
unpooling is part of the convolution below it, so that b is subtracted once for each pair of equal
frames. In float32 tanh⁻¹ is rounded to 1e-7 of 1, not of the result.
"""

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae.fast.blocks import LayerSizes
from numpy_cae.fast.layer_convolution import DirectFilters, DirectPass, FilterSpectra, SpectralPass
from numpy_cae.fast.products import Memory, zeros
from numpy_cae.fast.thread_team import ThreadTeam, share, thread_team
from numpy_cae.models.conv_layer import ConvLayer

DIRECT_FRAMES = {"training": 120, "encoding": 50}
"""One window of at most so many frames for each thread of BLAS is convolved as defined: the spectra
of the filters would take longer than the products that they save."""

Filters = DirectFilters | FilterSpectra
Passes = Sequence[SpectralPass] | Sequence[DirectPass]
Layers = Sequence[ConvLayer]


class FastLayer:
    """One layer in both directions, with both pullbacks.

    Parameters
    ----------
    passes : Passes
        The convolutions of the encoder and the decoder.
    bound : float
        Where arctanh clips.
    y : (T/2, B, D) array
        Receives what the layer encodes: the input of the layer above.

    Attributes
    ----------
    b : (D,) array
        The bias; the caller sets it.
    db : (D,) array
        Its gradient for the windows of this thread.
    """

    def __init__(self, passes: Passes, bound: float, y: np.ndarray):
        self.encoder, self.decoder = passes
        self.bound = bound
        self.y = y
        self.b = np.zeros(y.shape[2], y.dtype)
        self.db = np.zeros_like(self.b)
        self._clipped = zeros(y.shape, y.dtype)
        self._scratch = zeros(y.shape, y.dtype)
        self._earlier_won = np.empty(y.shape, bool)
        self._inside = np.empty(y.shape, bool)
        self._first: np.ndarray | None = None

    def encode(self) -> None:
        """y = tanh(max(pairs of x * W) + b), equation 1."""
        convolved = self.encoder.forwards()
        earlier = convolved[0::2]
        later = convolved[1::2]
        np.greater_equal(earlier, later, out=self._earlier_won)
        y = np.maximum(earlier, later, out=self.y)
        y += self.b
        np.tanh(y, out=y)

    def decode(self, y: np.ndarray, first: np.ndarray | None) -> np.ndarray:
        """(Ψ†(tanh⁻¹(y)) - b) * W̃, equation 2: (T, B, C).

        `first`, (B, T/2, D), is the mask of `ops.unpool_random`.
        """
        np.clip(y, -self.bound, self.bound, out=self._clipped)
        np.equal(y, self._clipped, out=self._inside)
        z = self.decoder.above
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
        z -= self.b
        return self.decoder.backwards()

    def decode_pullback(self, dy: np.ndarray) -> None:
        """From dx̂ in the decoder's `below` to dy; db gets the decoder's share."""
        dz = self.decoder.forwards()
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
        slope = np.multiply(self.y, self.y, out=self._scratch)
        np.subtract(1, slope, out=slope)
        dy *= slope
        self.db += dy.sum(axis=(0, 1))
        d_convolved = self.encoder.above
        np.multiply(dy, self._earlier_won, out=d_convolved[0::2])
        np.subtract(dy, d_convolved[0::2], out=d_convolved[1::2])
        return self.encoder.backwards(with_dx)


class Worker:
    """The buffers of one thread for its `windows` of a batch of B; b of them.

    Arguments and results are those of the thread's windows, in the order of the definition,
    (b, T, C); a result is valid until the next call.

    Attributes
    ----------
    layers : list of FastLayer
    loss : float
        The thread's part of the loss.
    """

    def __init__(self, windows: slice, filters: Sequence[Filters], bounds: Sequence[float]):
        self.windows = windows
        sizes = filters[-1].sizes
        batch = windows.stop - windows.start
        self._top = zeros((sizes.frames // 2, batch, sizes.filters), sizes.dtype)
        memory = Memory(sizes.dtype), Memory(sizes.dtype)
        passes = [each.passes(windows, memory) for each in filters]
        outputs = [encoder.below for encoder, _ in passes[1:]] + [self._top]
        self.layers = [FastLayer(*each) for each in zip(passes, bounds, outputs, strict=True)]
        self.loss = 0.0
        self._batch = sizes.batch
        self._d_top = zeros(self._top.shape, sizes.dtype)
        self._y = self._top.transpose(1, 0, 2)

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Φ(x), (b, t, D)."""
        self.layers[0].encoder.below[...] = x.transpose(1, 0, 2)
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
        error = self.layers[0].decoder.below
        np.subtract(decoded, x.transpose(1, 0, 2), out=error)
        elements = self._batch * x[0].size
        self.loss = float(np.multiply(error, error, out=decoded).sum()) / elements
        error *= 2 / elements

        above = [layer.decoder.below for layer in self.layers[1:]] + [self._d_top]
        for layer, dy in zip(self.layers, above, strict=True):  # dy is dx̂ of the layer above
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
        for layer, mask in reversed(list(zip(self.layers, first, strict=True))):
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
        self.filters: list[Filters] = []
        for each in sizes:
            most = DIRECT_FRAMES["training" if each.training else "encoding"] * self.blas_threads
            direct = batch == 1 and each.frames <= most
            self.filters.append(DirectFilters(each) if direct else FilterSpectra(each))
        parts = [share(batch, number, sharing) for number in range(sharing)]
        self.workers = [Worker(part, self.filters, bounds) for part in parts]

    def run(
        self, layers: Layers, work: Callable[[Worker], None], dws: Sequence[np.ndarray] = ()
    ) -> None:
        """Call work(worker) for every worker, with the W of these layers; then compute `dws`."""
        changed = []
        for k, (filters, layer) in enumerate(zip(self.filters, layers, strict=True)):
            for worker in self.workers:
                worker.layers[k].b = layer.b
            w = np.ascontiguousarray(layer.w, filters.sizes.dtype)
            if isinstance(filters, DirectFilters):
                filters.w = w
            elif filters.copy != w.data:
                filters.copy = None
                changed.append((filters, w))

        def run_thread(number: int) -> None:
            def part(total: int) -> slice:
                return share(total, number, self.team.size)

            for spectra, w in changed:
                spectra.load(w, part)
            if changed:
                self.team.wait()
            for worker in self.workers[number : number + 1]:
                work(worker)
            if dws:
                self.team.wait()
                for filters, dw in zip(self.filters, dws, strict=True):
                    filters.gradient(dw, part)

        self.team.run(run_thread, self.blas_threads)
        for spectra, w in changed:
            spectra.copy = None if spectra.sizes.training else bytearray(w.data)
