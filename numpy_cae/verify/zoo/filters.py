"""Wrong transposes of a filter bank. The right one is `numpy_cae.ops.transpose_filters`."""

from __future__ import annotations

from numpy_cae.verify.zoo.bug import bug


@bug("transpose_filters", caught_by="value")
def filters_not_flipped(w):
    """The channels are exchanged, but the taps are not flipped in time."""
    return w.transpose(0, 2, 1), lambda dw_tilde: dw_tilde.transpose(0, 2, 1)


@bug("transpose_filters", caught_by="value")
def filters_all_reversed(w):
    """The whole array is turned around: the channels are reversed as well as the taps."""
    return w[::-1, ::-1, ::-1].transpose(0, 2, 1), lambda d: d[::-1, ::-1, ::-1].transpose(0, 2, 1)


@bug("transpose_filters", caught_by="value")
def filters_reshaped(w):
    """A reshape takes the place of the transpose: the right shape, the numbers in wrong places."""
    taps, channels, filters = w.shape
    return w[::-1].reshape(taps, filters, channels), lambda d: d.reshape(w.shape)[::-1]


@bug("transpose_filters", caught_by="gradient for w")
def filters_pullback_not_flipped(w):
    """The pullback exchanges the channels but does not flip the taps back."""
    return w[::-1].transpose(0, 2, 1), lambda dw_tilde: dw_tilde.transpose(0, 2, 1)


@bug("transpose_filters", caught_by="gradient for w")
def filters_pullback_not_exchanged(w):
    """The pullback flips the taps back but does not exchange the channels."""
    return w[::-1].transpose(0, 2, 1), lambda dw_tilde: dw_tilde[::-1]
