"""Wrong pooling, by maximum and by mean. The right ones are in `numpy_cae.ops.pooling`."""

from __future__ import annotations

import numpy as np

from numpy_cae.verify.zoo.bug import bug


def pairs(x):
    return x[:, 0::2], x[:, 1::2]


def interleaved(earlier, later):
    batch, frames, channels = earlier.shape
    return np.stack([earlier, later], axis=2).reshape(batch, 2 * frames, channels)


@bug("max_pool", caught_by="loser")
def pool_gradient_to_both(x):
    """Both frames of a pair get the gradient, the smaller one too."""
    return np.maximum(*pairs(x)), lambda dy: np.repeat(dy, 2, axis=1)


@bug("max_pool", caught_by="gradient for x")
def pool_gradient_halved(x):
    """The gradient is spread evenly over both frames, as if it were the mean."""
    return np.maximum(*pairs(x)), lambda dy: np.repeat(dy / 2, 2, axis=1)


@bug("max_pool", caught_by="gradient for x")
def pool_gradient_to_loser(x):
    """The comparison is the wrong way round: the gradient goes to the smaller frame."""
    earlier, later = pairs(x)
    won = earlier < later
    return np.maximum(earlier, later), lambda dy: interleaved(dy * won, dy * ~won)


@bug("max_pool", caught_by="gradient for x")
def pool_gradient_to_earlier(x):
    """The gradient always goes to the earlier frame."""
    return np.maximum(*pairs(x)), lambda dy: interleaved(dy, np.zeros_like(dy))


@bug("max_pool", caught_by="ties")
def pool_ties_split(x):
    """The gradient of a tie is split between both frames."""
    earlier, later = pairs(x)
    share = (earlier > later) + 0.5 * (earlier == later)
    share = share.astype(x.dtype)
    return np.maximum(earlier, later), lambda dy: interleaved(dy * share, dy * (1 - share))


@bug("max_pool", caught_by="ties")
def pool_ties_to_later(x):
    """A tie goes to the later frame."""
    earlier, later = pairs(x)
    won = earlier > later
    return np.maximum(earlier, later), lambda dy: interleaved(dy * won, dy * ~won)


@bug("max_pool", caught_by="ties")
def pool_ties_doubled(x):
    """The winner is whoever equals the maximum: of a tie both frames get the whole gradient."""
    y = np.maximum(*pairs(x))
    return y, lambda dy: np.repeat(dy, 2, axis=1) * (x == np.repeat(y, 2, axis=1))


@bug("max_pool", caught_by="value")
def pool_averages(x):
    """It takes the mean of the pair, not the larger."""
    earlier, later = pairs(x)
    return (earlier + later) / 2, lambda dy: np.repeat(dy / 2, 2, axis=1)


@bug("max_pool", caught_by="value")
def pool_by_magnitude(x):
    """It keeps the frame with the larger magnitude, so that -2 beats 1."""
    earlier, later = pairs(x)
    won = np.abs(earlier) >= np.abs(later)
    return np.where(won, earlier, later), lambda dy: interleaved(dy * won, dy * ~won)


@bug("max_pool", caught_by="value")
def pool_halves_of_the_window(x):
    """It pairs frame t with frame t + T/2, the halves of the window, not neighbours."""
    middle = x.shape[1] // 2
    head, tail = x[:, :middle], x[:, middle:]
    won = head >= tail
    return np.maximum(head, tail), lambda dy: np.concatenate([dy * won, dy * ~won], axis=1)


@bug("max_pool", caught_by="purity")
def pool_writes_into_its_input(x):
    """The maximum is written into x itself."""
    earlier, later = pairs(x)
    won = earlier >= later
    np.maximum(earlier, later, out=earlier)
    return earlier.copy(), lambda dy: interleaved(dy * won, dy * ~won)


@bug("average_pool", caught_by="gradient for x")
def average_pullback_without_half(x):
    """The pullback gives both frames the whole gradient, not half of it each."""
    return sum(pairs(x)) / 2, lambda dy: np.repeat(dy, 2, axis=1)


@bug("average_pool", caught_by="gradient for x")
def average_gradient_to_larger(x):
    """The gradient goes to the larger frame, as if the mean were the maximum."""
    earlier, later = pairs(x)
    won = earlier >= later
    return (earlier + later) / 2, lambda dy: interleaved(dy * won, dy * ~won)


@bug("average_pool", caught_by="value")
def average_is_a_sum(x):
    """It adds the pair and forgets to halve, forward and backward."""
    return sum(pairs(x)), lambda dy: np.repeat(dy, 2, axis=1)


@bug("average_pool", caught_by="adjoint in x")
def average_pullback_tiled(x):
    """np.tile takes the place of np.repeat in the pullback: the window twice, not each frame."""
    return sum(pairs(x)) / 2, lambda dy: np.tile(dy / 2, (1, 2, 1))


@bug("average_pool", caught_by="equal frames")
def average_by_root_mean_square(x):
    """It takes the root mean square of the pair, so that two frames of -1 become 1."""
    earlier, later = pairs(x)
    y = np.sqrt((earlier**2 + later**2) / 2)
    return y, lambda dy: interleaved(dy * earlier / (2 * y), dy * later / (2 * y))
