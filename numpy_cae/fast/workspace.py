"""Everything that a step needs, allocated once: the layers of each thread, and what they share.

The threads divide the windows of a batch. They have ŵ in common, of which each transforms some
rows, and dw, of which each computes some channels when the spectra of all windows are known.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae.fast.fast_layer import FastLayer
from numpy_cae.fast.filter_spectra import FilterSpectra, buffer
from numpy_cae.fast.thread_team import ThreadTeam, share
from numpy_cae.fast.tied_convolution import TiedConvolution, cheapest_length
from numpy_cae.models.conv_layer import ConvLayer

LayerShape = tuple[tuple[int, int, int], float]
"""(taps, channels, filters) and the bound of arctanh."""


class Worker:
    """The buffers of one thread: its layers, for its `windows` of the batch.

    `top` and `d_top`, (t, B·D), are the hidden units and the gradient for them; `db` its part of
    the gradients of each layer's b.
    """

    def __init__(
        self,
        number: int,
        windows: slice,
        convolutions: list[TiedConvolution],
        shapes: Sequence[LayerShape],
    ):
        self.number, self.windows = number, windows
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
    """The workers of a team, for one size of batch and window.

    Parameters
    ----------
    shapes, unpooled_evenly : tuples with one element for each layer
    batch, frames : int
    dtype : dtype
    team : ThreadTeam
    training : bool
        Whether gradients for the weights will be computed: then ŵ is transformed in every run,
        since every step changes the weights, and the block length takes that into account.

    Attributes
    ----------
    content : object
        A new one for each run, to tell whether the buffers still belong to an earlier run.
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
        self.team, self.training, self.content = team, training, object()
        self._copies: list[tuple[np.dtype, bytearray]] = []
        windows = [share(batch, number, team.size) for number in range(team.size)]
        # Without gradients the time depends on the windows of one thread, each reading all of ŵ.
        together = batch if training else -(-batch // team.size)
        self.spectra = [
            FilterSpectra(
                shape,
                batch,
                frames >> k,
                cheapest_length(*shape, together, frames >> k, training),
                dtype,
            )
            for k, (shape, _) in enumerate(shapes)
        ]
        self.workers = []
        for number, part in enumerate(windows):
            convolutions = [
                TiedConvolution(spectra, part, frames >> k, evenly)
                for k, (spectra, evenly) in enumerate(
                    zip(self.spectra, unpooled_evenly, strict=True)
                )
            ]
            self.workers.append(Worker(number, part, convolutions, shapes))

    def run(
        self,
        layers: Sequence[ConvLayer],
        work: Callable[[Worker], None],
        same_weights: bool = False,
    ) -> None:
        """Call work(worker) for every worker, with the ŵ of these layers.

        Unless the caller knows that W is that of the last run (`same_weights`), W is compared with
        a copy, bit by bit, and ŵ computed anew where it has changed.
        """
        self.content = object()
        if same_weights or self._is_current(layers):
            self.team.run(lambda number: work(self.workers[number]))
        else:
            self._transform_and_run(layers, work)

    def _transform_and_run(
        self, layers: Sequence[ConvLayer], work: Callable[[Worker], None]
    ) -> None:
        """Compute ŵ = G w, each worker some of its rows, then work with it."""
        self._copies = []
        copies = [] if self.training else [(w.dtype, bytearray(w)) for w in _filters(layers)]

        def transform_and_work(number: int) -> None:
            for layer, spectra in zip(layers, self.spectra, strict=True):
                spectra.transform(layer.w, share(len(spectra.w_hat), number, self.team.size))
            self.team.wait(number)
            work(self.workers[number])

        self.team.run(transform_and_work)
        self._copies = copies

    def _is_current(self, layers: Sequence[ConvLayer]) -> bool:
        """Whether ŵ belongs to W: a bytearray is compared in one call, faster than an array."""
        return len(self._copies) == len(layers) and all(
            dtype == w.dtype and copy == w.data
            for (dtype, copy), w in zip(self._copies, _filters(layers), strict=True)
        )

    def filters_gradient(self, number: int, out: Sequence[np.ndarray]) -> None:
        """dw of every layer into `out`, called by all workers after their pullbacks."""
        self.team.wait(number)
        for dw, spectra in zip(out, self.spectra, strict=True):
            spectra.gradient(share(spectra.channels, number, self.team.size), dw)


def _filters(layers: Sequence[ConvLayer]) -> list[np.ndarray]:
    return [np.ascontiguousarray(layer.w) for layer in layers]
