"""Everything that a step needs, allocated once: the layers of each thread, and what they share.

The threads divide the windows of a batch. They have ŵ in common, of which each transforms some
rows, and dw, of which each computes some channels when the spectra of all windows are known.
"""

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae.fast.fast_layer import FastLayer
from numpy_cae.fast.filter_spectra import ROW_PADDING, FilterSpectra, buffer
from numpy_cae.fast.thread_team import ThreadTeam, share
from numpy_cae.fast.tied_convolution import TiedConvolution, cheapest_length
from numpy_cae.models.conv_layer import ConvLayer

MIN_WINDOWS_PER_THREAD = 2
"""Fewer windows are not shared between threads. (Threads that share the rows s of ŵ for one window,
and add up their parts of y, took two thirds more of the processor's time.)"""

LayerShape = tuple[tuple[int, int, int], float]
"""(taps, channels, filters) and the bound of arctanh."""


class Worker:
    """The buffers of one thread: its layers, for its `windows` of the batch.

    `top` and `d_top`, (t, B·D), are the hidden units and the gradient for them; `db` its part of
    the gradients of each layer's b.
    """

    def __init__(
        self, windows: slice, convolutions: list[TiedConvolution], shapes: Sequence[LayerShape]
    ):
        self.windows = windows
        batch = windows.stop - windows.start
        dtype = convolutions[-1].x.dtype
        top_shape = len(convolutions[-1].x) // 2, batch * shapes[-1][0][2]
        self.top, self.d_top = (buffer(*top_shape, dtype) for _ in range(2))
        outputs = [above.x for above in convolutions[1:]] + [self.top]
        self.layers = [
            FastLayer(convolution, bound, output)
            for convolution, (_, bound), output in zip(convolutions, shapes, outputs, strict=True)
        ]
        self.db = [np.empty(above, dtype) for (_, _, above), _ in shapes]
        self.loss = 0.0


class Workspace:
    """The workers of a team, at most one a thread, for one size of batch and window.

    Parameters
    ----------
    shapes, unpooled_evenly : tuples with one element for each layer
    batch, frames : int
    dtype : dtype
    team : ThreadTeam
    training : bool
        Whether gradients for the weights will be computed. Every step of training changes the
        weights, so ŵ is then computed in every run, and the block length is chosen for that.
    """

    def __init__(
        self,
        shapes: Sequence[LayerShape],
        batch: int,
        frames: int,
        dtype: np.dtype,
        unpooled_evenly: tuple[bool, ...],
        team: ThreadTeam,
        training: bool,
    ):
        self.team, self.training = team, training
        shapes = [_whole_lines(*shapes[0]), *shapes[1:]]
        self._copies: list[np.ndarray] = []
        sharing = max(1, min(team.size, batch // MIN_WINDOWS_PER_THREAD))
        windows = [share(batch, number, sharing) for number in range(sharing)]
        # Without gradients the time depends on the windows of one thread, each reading all of ŵ.
        together = batch if training else -(-batch // sharing)
        self.spectra = []
        for k, (shape, _) in enumerate(shapes):
            longest = cheapest_length(*shape, together, frames >> k, training)
            self.spectra.append(FilterSpectra(shape, batch, frames >> k, longest, dtype))
        self.workers = []
        for part in windows:
            layers = enumerate(zip(self.spectra, unpooled_evenly, strict=True))
            convolutions = [TiedConvolution(s, part, frames >> k, even) for k, (s, even) in layers]
            self.workers.append(Worker(part, convolutions, shapes))

    def run(
        self,
        layers: Sequence[ConvLayer],
        work: Callable[[Worker], None],
        same_weights: bool = False,
        dws: Sequence[np.ndarray] = (),
    ) -> None:
        """Call work(worker) for every worker, with the ŵ of these layers; then compute `dws`.

        Without `same_weights`, which says that W is that of the last run, W is compared with a
        copy bit by bit before the work begins, and where it differs ŵ is computed anew.
        """
        filters = [np.ascontiguousarray(layer.w) for layer in layers]
        copies = self._copies
        self._copies = []  # none in case of a failure
        equal = [same_weights] * self.team.size

        def run_thread(number: int) -> None:
            if copies and not same_weights:
                equal[number] = self._equal_part(number, filters, copies)
                self.team.wait()
            if not all(equal):
                self._transform_filters(number, filters)
            for worker in self.workers[number : number + 1]:
                work(worker)
            if dws:
                self._filters_gradient(number, dws)

        self.team.run(run_thread)
        if not self.training:
            self._copies = copies if all(equal) else [w.copy() for w in filters]

    def _transform_filters(self, number: int, filters: Sequence[np.ndarray]) -> None:
        """ŵ = G w: each thread computes some rows."""
        for w, spectra in zip(filters, self.spectra, strict=True):
            spectra.transform(w, share(len(spectra.w_hat), number, self.team.size))
        self.team.wait()

    def _filters_gradient(self, number: int, dws: Sequence[np.ndarray]) -> None:
        """dw, when the spectra of all windows are known: each thread computes some channels."""
        self.team.wait()
        for dw, spectra in zip(dws, self.spectra, strict=True):
            spectra.gradient(share(spectra.channels, number, self.team.size), dw)

    def _equal_part(
        self, number: int, filters: Sequence[np.ndarray], copies: Sequence[np.ndarray]
    ) -> bool:
        """Whether this thread's share of W equals that of the copies."""
        return all(
            w.dtype == copy.dtype and np.array_equal(_bits(w)[part], _bits(copy)[part])
            for w, copy in zip(filters, copies, strict=True)
            for part in [share(_bits(w).size, number, self.team.size)]
        )


def _whole_lines(shape: tuple[int, int, int], bound: float) -> LayerShape:
    """The shape with channels of zeros added, so that a frame of data fills its cache lines."""
    taps, channels, filters = shape
    return (taps, -(-channels // ROW_PADDING) * ROW_PADDING, filters), bound


def _bits(array: np.ndarray) -> np.ndarray:
    """A contiguous array as integers, the same memory."""
    return array.reshape(-1).view(f"u{min(array.itemsize, 8)}")
