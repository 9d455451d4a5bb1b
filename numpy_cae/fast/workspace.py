"""Everything that a step needs, allocated once: the layers of each thread, and what they share.

The threads divide the windows of a batch. They have the filters in common: each transforms some
rows of ŵ, and computes a part of dw when all windows have been pulled back.
A worker takes one thread's windows through all layers and back.
"""

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae.fast.blocks import LayerSizes
from numpy_cae.fast.fast_layer import FastLayer
from numpy_cae.fast.layer_convolution import (
    DirectConvolution,
    FilterSpectra,
    SpectralConvolution,
)
from numpy_cae.fast.products import Memory, zeros
from numpy_cae.fast.thread_team import ThreadTeam, share, thread_team
from numpy_cae.models.conv_layer import ConvLayer

DIRECT_FRAMES = {"training": 120, "encoding": 50}
"""One window of at most so many frames for each thread of BLAS is convolved as defined: the spectra
of the filters would take longer than the products that they save."""

Filters = DirectConvolution | FilterSpectra
Layers = Sequence[ConvLayer]


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
        convolutions = [
            SpectralConvolution(each, windows, memory) if isinstance(each, FilterSpectra) else each
            for each in filters
        ]
        outputs = [above.x for above in convolutions[1:]] + [self._top]
        self.layers = [
            FastLayer(convolution, bound, output)
            for convolution, bound, output in zip(convolutions, bounds, outputs, strict=True)
        ]
        self.loss = 0.0
        self._batch = sizes.batch
        self._d_top = zeros(self._top.shape, sizes.dtype)
        self._y = self._top.transpose(1, 0, 2)

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Φ(x), (b, t, D)."""
        self.layers[0].convolution.x[...] = x.transpose(1, 0, 2)
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
        error = self.layers[0].convolution.error
        np.subtract(decoded, x.transpose(1, 0, 2), out=error)
        elements = self._batch * x[0].size
        self.loss = float(np.multiply(error, error, out=decoded).sum()) / elements
        error *= 2 / elements

        above = [layer.convolution.error for layer in self.layers[1:]] + [self._d_top]
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
            self.filters.append(DirectConvolution(each) if direct else FilterSpectra(each))
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
            if isinstance(filters, DirectConvolution):
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
