"""Wrong losses. The right ones are in `numpy_cae.ops.losses`."""

from __future__ import annotations

import numpy as np

from numpy_cae.verify.zoo.bug import bug


@bug("mean_squared_error", caught_by="gradient for x_hat")
def squared_without_two(x_hat, x):
    """The derivative of a square without its factor of 2."""
    gap = x_hat - x
    return np.mean(gap * gap), lambda dloss=1.0: float(dloss) / gap.size * gap


@bug("mean_squared_error", caught_by="gradient for x_hat")
def squared_without_count(x_hat, x):
    """The gradient is that of the sum: the division by N is missing."""
    gap = x_hat - x
    return np.mean(gap * gap), lambda dloss=1.0: 2 * float(dloss) * gap


@bug("mean_squared_error", caught_by="gradient for x_hat")
def squared_sign_lost(x_hat, x):
    """x - x_hat in the pullback: the sign is wrong, and descent climbs."""
    gap = x_hat - x
    return np.mean(gap * gap), lambda dloss=1.0: 2 * float(dloss) / gap.size * (x - x_hat)


@bug("mean_squared_error", caught_by="gradient for x_hat")
def squared_ignores_upstream(x_hat, x):
    """The upstream number is ignored: right alone, wrong as a term of something larger."""
    gap = x_hat - x
    return np.mean(gap * gap), lambda dloss=1.0: 2 / gap.size * gap


@bug("mean_squared_error", caught_by="value")
def squared_over_windows(x_hat, x):
    """A sum over frames and features, a mean over windows alone."""
    gap = x_hat - x
    return np.sum(gap * gap) / len(x), lambda dloss=1.0: 2 * float(dloss) / len(x) * gap


@bug("mean_squared_error", caught_by="value")
def squared_rooted(x_hat, x):
    """It returns the root of the mean square."""
    gap = x_hat - x
    loss = np.sqrt(np.mean(gap * gap))

    def pullback(dloss=1.0):
        return np.divide(float(dloss) * gap, gap.size * loss, where=loss > 0, out=0 * gap)

    return loss, pullback


@bug("mean_squared_error", caught_by="zero at the target")
def squared_never_zero(x_hat, x):
    """A tiny number is added inside 'for safety': at the target the loss is not 0."""
    gap = x_hat - x
    loss = np.mean(gap * gap + gap.dtype.type(1e-12))
    return loss, lambda dloss=1.0: 2 * float(dloss) / gap.size * gap


@bug("mean_squared_error", caught_by="upstream default")
def squared_half_by_default(x_hat, x):
    """The upstream number defaults to a half, to make the 2 go away."""
    gap = x_hat - x
    return np.mean(gap * gap), lambda dloss=0.5: 2 * float(dloss) / gap.size * gap


@bug("mean_absolute", caught_by="gradient for y")
def absolute_without_sign(y):
    """The gradient is 1 / N everywhere: the sign is missing."""
    return np.mean(np.abs(y)), lambda dloss=1.0: np.full_like(y, float(dloss) / y.size)


@bug("mean_absolute", caught_by="gradient for y")
def absolute_without_count(y):
    """The gradient is that of the sum: the division by N is missing."""
    return np.mean(np.abs(y)), lambda dloss=1.0: float(dloss) * np.sign(y)


@bug("mean_absolute", caught_by="gradient for y")
def absolute_gradient_of_square(y):
    """The gradient is 2 y / N, that of the mean square."""
    return np.mean(np.abs(y)), lambda dloss=1.0: 2 * float(dloss) / y.size * y


@bug("mean_absolute", caught_by="zero at zero")
def absolute_positive_at_zero(y):
    """At 0 the sign is taken to be +1, and zero units are pushed away from 0."""
    sign = np.where(y >= 0, 1.0, -1.0).astype(y.dtype)
    return np.mean(np.abs(y)), lambda dloss=1.0: float(dloss) / y.size * sign


@bug("mean_absolute", caught_by="zero at zero")
def absolute_divides_by_itself(y):
    """The sign is y / |y|, which is nan at 0."""
    with np.errstate(invalid="ignore"):
        sign = y / np.abs(y)
    return np.mean(np.abs(y)), lambda dloss=1.0: float(dloss) / y.size * sign


@bug("mean_absolute", caught_by="value")
def absolute_of_the_mean(y):
    """The absolute value of the mean, in which positive and negative units cancel."""
    mean = np.mean(y)
    sign = np.sign(mean)
    return np.abs(mean), lambda dloss=1.0: np.full_like(y, float(dloss) * sign / y.size)
