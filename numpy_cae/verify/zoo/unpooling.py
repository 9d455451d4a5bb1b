"""Wrong inverses of max pooling. The right ones are in `numpy_cae.ops.pooling`."""

from __future__ import annotations

import numpy as np

from numpy_cae.verify.zoo.bug import bug
from numpy_cae.verify.zoo.pooling import interleaved, pairs


@bug("unpool_even", caught_by="gradient for y")
def even_pullback_without_half(y):
    """The pullback adds both frames but forgets the half: a factor of 2."""
    return np.repeat(y / 2, 2, axis=1), lambda dx: sum(pairs(dx))


@bug("unpool_even", caught_by="gradient for y")
def even_pullback_earlier_only(y):
    """The pullback looks at the earlier frame alone."""
    return np.repeat(y / 2, 2, axis=1), lambda dx: pairs(dx)[0] / 2


@bug("unpool_even", caught_by="pair sums")
def even_whole_value(y):
    """Both frames get the whole value, so that a pair sums to 2 y."""
    return np.repeat(y, 2, axis=1), lambda dx: sum(pairs(dx))


@bug("unpool_even", caught_by="value")
def even_tiled(y):
    """np.tile takes the place of np.repeat: the window twice, not each frame twice."""
    frames = y.shape[1]
    return np.tile(y / 2, (1, 2, 1)), lambda dx: (dx[:, :frames] + dx[:, frames:]) / 2


@bug("unpool_even", caught_by="adjoint in y")
def even_pullback_shifted(y):
    """The pullback pairs frames 1 and 2, 3 and 4, …: off by one."""
    return np.repeat(y / 2, 2, axis=1), lambda dx: sum(pairs(np.roll(dx, -1, axis=1))) / 2


@bug("unpool_random", caught_by="gradient for y")
def random_mask_negated(y, first):
    """The pullback reads the mask the wrong way round."""
    x = interleaved(y * first, y * ~first)
    return x, lambda dx: pairs(dx)[0] * ~first + pairs(dx)[1] * first


@bug("unpool_random", caught_by="gradient for y")
def random_mask_redrawn(y, first):
    """The pullback draws its own mask instead of using the one of the forward pass."""
    x = interleaved(y * first, y * ~first)

    def pullback(dx):
        other = np.random.default_rng(0).random(y.shape) < 0.5
        return pairs(dx)[0] * other + pairs(dx)[1] * ~other

    return x, pullback


@bug("unpool_random", caught_by="gradient for y")
def random_gradient_of_both(y, first):
    """The pullback adds the gradients of both frames, the empty one's too."""
    return interleaved(y * first, y * ~first), lambda dx: sum(pairs(dx))


@bug("unpool_random", caught_by="value")
def random_second_where_first(y, first):
    """The mask means the second frame here, forward and backward."""
    return interleaved(y * ~first, y * first), lambda dx: np.where(first, dx[:, 1::2], dx[:, 0::2])


@bug("unpool_random", caught_by="value")
def random_mask_of_one_channel(y, first):
    """The mask of the first channel is used for all of them."""
    first = np.broadcast_to(first[..., :1], y.shape)
    x = interleaved(y * first, y * ~first)
    return x, lambda dx: np.where(first, dx[:, 0::2], dx[:, 1::2])


@bug("unpool_random", caught_by="empty slot")
def random_slot_nearly_empty(y, first):
    """The other frame gets a tiny number 'for safety', not exactly 0."""
    x = interleaved(np.where(first, y, 1e-12), np.where(first, 1e-12, y)).astype(y.dtype)
    return x, lambda dx: np.where(first, dx[:, 0::2], dx[:, 1::2])


@bug("unpool_random", caught_by="pair sums")
def random_value_halved(y, first):
    """Half the value, as in even unpooling, on one frame: a pair sums to y / 2."""
    x = interleaved(y * first, y * ~first) / 2
    return x, lambda dx: np.where(first, dx[:, 0::2], dx[:, 1::2]) / 2
