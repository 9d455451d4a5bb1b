"""Everything that a step needs, allocated once: the layers of each thread, and what they share.

The threads divide the windows of a batch. They have the filters in common: each transforms some
rows of ŵ, and computes a part of dw when all windows have been pulled back.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.fast.direct_convolution import DirectConvolution
from numpy_cae.fast.layer_sizes import LayerSizes, cheapest_length
from numpy_cae.fast.products import ROW_PADDING
from numpy_cae.fast.spectral_convolution import FilterSpectra
from numpy_cae.fast.thread_team import ThreadTeam, share, thread_team
from numpy_cae.fast.worker import Filters, Worker
from numpy_cae.models.conv_layer import ConvLayer


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
        # Without gradients the time is that of the windows of one thread, each reading all of ŵ.
        windows = batch if sizes[0].training else -(-batch // sharing)
        self.filters: list[Filters] = []
        for each in sizes:
            longest = cheapest_length(each, windows, self.blas_threads)
            if longest == 1:
                self.filters.append(DirectConvolution(each))
            else:
                padded = _whole_lines(each) if each is sizes[0] else each
                self.filters.append(FilterSpectra(padded, longest))
        parts = [share(batch, number, sharing) for number in range(sharing)]
        self.workers = [Worker(part, self.filters, bounds, sizes[0].channels) for part in parts]

    def run(
        self,
        layers: Sequence[ConvLayer],
        work: Callable[[Worker], None],
        dws: Sequence[np.ndarray] = (),
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


def _whole_lines(sizes: LayerSizes) -> LayerSizes:
    """With channels of zeros, so that a frame of data fills its cache lines."""
    return replace(sizes, channels=-(-sizes.channels // ROW_PADDING) * ROW_PADDING)
