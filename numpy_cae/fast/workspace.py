"""Everything that a step needs, allocated once: each member's layers and what they share.

The members of a team share out the windows of a batch. They have ŵ in common, each transforming
some of its rows, and add up at the end what each has found of its gradient.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae.fast.layer import FastLayer
from numpy_cae.fast.products import multiply_columns
from numpy_cae.fast.team import Team, share
from numpy_cae.fast.tied_convolution import TiedConvolution, buffer, cheapest_length
from numpy_cae.models.conv_layer import ConvLayer


class Member:
    """What one thread works with.

    Attributes
    ----------
    number : int
        The first is 0.
    windows : slice
        Its share of the batch.
    layers : list of FastLayer, lowest first
    dw : list of (K, C·D) arrays
        What this member contributes to the gradient of W.
    db : list of (D,) arrays
    """

    def __init__(
        self, number: int, windows: slice, convolutions: list[TiedConvolution], layers, halved
    ):
        self.number, self.windows = number, windows
        batch = windows.stop - windows.start
        top, dtype = layers[-1], convolutions[-1].w_hat.dtype
        frames = len(convolutions[-1].x) // 2
        places = [above.x for above in convolutions[1:]]
        places.append(buffer(frames, batch * top.b.size, dtype))
        self.layers = [
            FastLayer(convolution, layer.bound, place, even)
            for convolution, layer, place, even in zip(
                convolutions, layers, places, halved, strict=True
            )
        ]
        self.top = places[-1]
        self.d_top = buffer(frames, batch * top.b.size, dtype)
        self.dw = [np.empty((len(layer.w), layer.w[0].size), dtype) for layer in layers]
        self.db = [np.empty(layer.b.size, dtype) for layer in layers]
        self.loss = 0.0


class Workspace:
    """The members of a team and their buffers, for one size of batch and window.

    Parameters
    ----------
    layers : sequence of ConvLayer
        Of which only the shapes and the bounds are taken.
    batch, frames : int
    dtype : dtype
    halved : tuple of bool
        For each layer, whether unpooling is even.
    team : Team
    training : bool
        Whether gradients will be asked for; the blocks are as long as suits that.
    """

    def __init__(
        self,
        layers: Sequence[ConvLayer],
        batch: int,
        frames: int,
        dtype: np.dtype,
        halved: tuple[bool, ...],
        team: Team,
        training: bool,
    ):
        self.team = team
        self._transformed: list[np.ndarray] = []
        self._up_to_date = False
        windows = [share(batch, member, team.size) for member in range(team.size)]
        convolutions = [
            _convolutions(
                layers, each.stop - each.start, batch, team.size, frames, dtype, halved, training
            )
            for each in windows
        ]
        for peers in zip(*convolutions, strict=True):
            for convolution in peers:
                convolution.share_spectrum(peers)
        self.members = [
            Member(number, each, own, layers, halved)
            for number, (each, own) in enumerate(zip(windows, convolutions, strict=True))
        ]

    def run(
        self, layers: Sequence[ConvLayer], work: Callable[[Member], None], again: bool = False
    ) -> None:
        """work(member) for every member, with the ŵ of these layers in place.

        `again` says that W is what it was at the last run.
        """
        self._up_to_date = self._knows(layers, again)
        if not self._up_to_date:
            self._transformed = []

        def with_filters(number: int) -> None:
            self._transform_filters(layers, number)
            work(self.members[number])

        self.team.run(with_filters)
        self._transformed = [layer.w for layer in layers]

    def _transform_filters(self, layers: Sequence[ConvLayer], member: int) -> None:
        """ŵ = G w of every layer, unless it is known and w cannot have changed since."""
        if self._up_to_date:
            return
        for k, layer in enumerate(layers):
            convolution = self.members[member].layers[k].convolution
            convolution.transform_filters(layer.w, self._filter_rows(convolution, member))
        self.team.wait(member)

    def _knows(self, layers: Sequence[ConvLayer], again: bool) -> bool:
        """Whether ŵ is that of these very arrays, and they cannot have changed since."""
        return len(self._transformed) == len(layers) and all(
            layer.w is known and (again or not known.flags.writeable)
            for layer, known in zip(layers, self._transformed, strict=True)
        )

    def filters_gradient(self, own: Member, out: Sequence[np.ndarray]) -> None:
        """dw = Gᵀ dŵ of every layer into `out`, when all members have gone down and back up."""
        member = own.number
        for layer in own.layers:
            layer.convolution.filters_gradient()
        self.team.wait(member)
        for k, layer in enumerate(own.layers):
            convolution = layer.convolution
            rows = self._filter_rows(convolution, member)
            dw_hat = convolution.dw_hat[rows]
            for peer in self.members:
                if peer is not own:
                    dw_hat += peer.layers[k].convolution.dw_hat[rows]
            part = own.dw[k] if self.team.size > 1 else out[k].reshape(own.dw[k].shape)
            multiply_columns(convolution.g[rows].T, dw_hat[None], part[None])
        if self.team.size > 1:
            self.team.wait(member)
            self._add_up(member, out)

    def _add_up(self, member: int, out: Sequence[np.ndarray]) -> None:
        """What all members contribute to dw; each member adds up some of the taps."""
        for k, dw in enumerate(out):
            taps = share(len(dw), member, self.team.size)
            total = dw.reshape(len(dw), -1)[taps]
            one, two, *others = (peer.dw[k][taps] for peer in self.members)
            np.add(one, two, out=total)
            for another in others:
                total += another

    def _filter_rows(self, convolution: TiedConvolution, member: int) -> slice:
        """The rows of ŵ and dŵ that a member transforms."""
        return share(len(convolution.w_hat), member, self.team.size)


def _convolutions(
    layers: Sequence[ConvLayer],
    windows: int,
    batch: int,
    members: int,
    frames: int,
    dtype: np.dtype,
    halved: tuple[bool, ...],
    training: bool,
) -> list[TiedConvolution]:
    """A member's, for its windows out of a batch; the length of blocks is the same for all."""
    made = []
    # Every member reads all of ŵ for its own windows: without training's other work that decides.
    together = batch if training else -(-batch // members)
    for k, layer in enumerate(layers):
        longest = cheapest_length(*layer.w.shape, together, frames >> k, training)
        made.append(TiedConvolution(layer.w.shape, windows, frames >> k, longest, dtype, halved[k]))
    return made
