"""The solutions of lesson 12, trust nobody's gradients."""

import numpy as np

from numpy_cae.course.suspects import accuse as accuse


def central_differences(f, x, h):
    """(f(x + h) - f(x - h)) / 2h for every entry of x."""
    slopes = np.empty(x.shape)
    for index in np.ndindex(x.shape):
        step = np.zeros(x.shape)
        step[index] = h
        slopes[index] = (f(x + step) - f(x - step)) / (2 * h)
    return slopes


def adjoint_gap(f, x, y):
    """|<A x, y> - <x, A' y>| relative to the norms of the factors."""
    value, pullback = f(x)
    pulled = pullback(y)
    size = np.linalg.norm(value) * np.linalg.norm(y) + np.linalg.norm(x) * np.linalg.norm(pulled)
    return abs(np.sum(value * y) - np.sum(x * pulled)) / size


def check_gradients(f, inputs):
    """Raise an AssertionError unless the pullback of f agrees with differences."""
    value, pullback = f(*inputs.values())
    dy = np.random.default_rng(0).standard_normal(np.shape(value))
    gradients = pullback(dy)
    if len(inputs) == 1:
        gradients = (gradients,)
    for (name, x), gradient in zip(inputs.items(), gradients, strict=True):

        def loss(moved, name=name):
            return np.sum(dy * f(*{**inputs, name: moved}.values())[0])

        numeric = central_differences(loss, x, 1e-5 * np.abs(x).max())
        assert np.shape(gradient) == x.shape, f"the gradient for {name} has the wrong shape"
        gap = np.linalg.norm(gradient - numeric)
        allowed = 1e-6 * (np.linalg.norm(gradient) + np.linalg.norm(numeric))
        assert gap <= allowed, f"the gradient for {name} is wrong, by {gap:.2g}"
