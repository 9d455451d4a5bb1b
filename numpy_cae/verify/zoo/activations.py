"""Wrong nonlinearities. The right ones are in `numpy_cae.ops.activations`."""

from __future__ import annotations

import numpy as np

from numpy_cae.verify.zoo.bug import bug


@bug("tanh", caught_by="gradient for x")
def tanh_derivative_of_x(x):
    """The derivative is 1 - x², where it should be 1 - y²."""
    return np.tanh(x), lambda dy: dy * (1 - x * x)


@bug("tanh", caught_by="gradient for x")
def tanh_derivative_not_squared(x):
    """The derivative is 1 - y: the square is missing."""
    y = np.tanh(x)
    return y, lambda dy: dy * (1 - y)


@bug("tanh", caught_by="gradient for x")
def tanh_without_derivative(x):
    """The upstream gradient is passed on as it is."""
    return np.tanh(x), lambda dy: dy


@bug("tanh", caught_by="gradient for x")
def tanh_without_upstream(x):
    """The derivative is returned alone, not multiplied by the upstream gradient."""
    y = np.tanh(x)
    return y, lambda dy: 1 - y * y


@bug("tanh", caught_by="large inputs")
def tanh_overflows(x):
    """(exp(x) - exp(-x)) / (exp(x) + exp(-x)) is inf / inf for large x."""
    with np.errstate(all="ignore"):
        y = (np.exp(x) - np.exp(-x)) / (np.exp(x) + np.exp(-x))
    return y, lambda dy: dy * (1 - y * y)


@bug("sigmoid", caught_by="gradient for x")
def sigmoid_derivative_of_x(x):
    """The derivative is x (1 - x), where it should be y (1 - y)."""
    y = 1 / (1 + np.exp(-x))
    return y, lambda dy: dy * x * (1 - x)


@bug("sigmoid", caught_by="gradient for x")
def sigmoid_derivative_of_tanh(x):
    """The derivative is tanh's, 1 - y²."""
    y = 1 / (1 + np.exp(-x))
    return y, lambda dy: dy * (1 - y * y)


@bug("sigmoid", caught_by="large inputs")
def sigmoid_overflows(x):
    """exp(x) / (1 + exp(x)) is inf / inf for large x."""
    with np.errstate(all="ignore"):
        y = np.exp(x) / (1 + np.exp(x))
    return y, lambda dy: dy * y * (1 - y)


@bug("sigmoid", caught_by="value")
def sigmoid_sign_lost(x):
    """1 / (1 + exp(x)): the minus is missing, in the derivative likewise."""
    y = 1 / (1 + np.exp(x))
    return y, lambda dy: -dy * y * (1 - y)


@bug("arctanh", caught_by="beyond the bound")
def arctanh_gradient_beyond_bound(y, bound):
    """Beyond the bound, where the clipped value no longer moves, there is still a gradient."""
    clipped = np.clip(y, -bound, bound)
    return np.arctanh(clipped), lambda dx: dx / (1 - clipped * clipped)


@bug("arctanh", caught_by="gradient for y")
def arctanh_gradient_of_unclipped(y, bound):
    """The derivative uses y before the clip: negative beyond 1."""
    return np.arctanh(np.clip(y, -bound, bound)), lambda dx: dx / (1 - y * y)


@bug("arctanh", caught_by="gradient for y")
def arctanh_derivative_of_arctan(y, bound):
    """The derivative is arctan's, 1 / (1 + y²)."""
    inside = np.abs(y) <= bound
    return np.arctanh(np.clip(y, -bound, bound)), lambda dx: dx * inside / (1 + y * y)


@bug("arctanh", caught_by="gradient for y")
def arctanh_derivative_of_tanh(y, bound):
    """The derivative is tanh's, 1 - y², which it is the reciprocal of."""
    inside = np.abs(y) <= bound
    return np.arctanh(np.clip(y, -bound, bound)), lambda dx: dx * inside * (1 - y * y)


@bug("arctanh", caught_by="inverse of tanh")
def arctanh_clips_its_value(y, bound):
    """The value is clipped to the bound, not the argument: it does not invert tanh."""
    with np.errstate(all="ignore"):
        x = np.nan_to_num(np.arctanh(np.clip(y, -1, 1)))
        inside = np.abs(x) <= bound
        slope = np.where(inside, 1 / (1 - y * y), 0)
    return np.clip(x, -bound, bound), lambda dx: dx * slope


@bug("arctanh", caught_by="beyond the bound")
def arctanh_clips_above_only(y, bound):
    """It is clipped from above but not from below."""
    inside = y <= bound
    with np.errstate(all="ignore"):
        x = np.arctanh(np.minimum(y, y.dtype.type(bound)))
        slope = np.where(inside, 1 / (1 - y * y), 0)
    return x, lambda dx: dx * slope
