"""Real bugs of other projects, re-enacted: docs/verify.md lists them with their links."""

import numpy as np
import pytest
from failing_properties import failing
from scipy.special import erf


def softmax(x):
    """numpy-transformer: the gradient is divided by the batch."""
    e = np.exp(x - x.max(axis=1, keepdims=True))
    y = e / e.sum(axis=1, keepdims=True)
    return y, lambda dy: y * (dy - (y * dy).sum(axis=1, keepdims=True)) / len(x)


def log_softmax(x):
    """numpy-transformer: the gradient is divided by the batch."""
    e = np.exp(x - x.max(axis=1, keepdims=True))
    total = e.sum(axis=1, keepdims=True)
    y = np.log(e / total)
    return y, lambda dy: (dy - e / total * dy.sum(axis=1, keepdims=True)) / len(x)


def scores(q, k):
    """numpy-transformer: the gradients for queries and keys are divided by the batch."""
    y = q @ k.swapaxes(1, 2)
    return y, lambda dy: (dy @ k / len(q), dy.swapaxes(1, 2) @ q / len(q))


def layer_norm(x, gamma):
    """numpy-transformer: gamma stands before the bracket, not inside both sums."""
    centred = x - x.mean(axis=1, keepdims=True)
    size = np.sqrt((centred**2).mean(axis=1, keepdims=True) + 0.5)
    normal = centred / size

    def pullback(dy):
        along = (dy * normal).mean(axis=1, keepdims=True)
        dx = gamma / size * (dy - dy.mean(axis=1, keepdims=True) - normal * along)
        return dx, (dy * normal).sum(axis=0)

    return gamma * normal, pullback


def cross_entropy(x):
    """numpy-transformer: the target, class 0, is found by its value: equal logits all count."""
    e = np.exp(x - x.max(axis=1, keepdims=True))
    y = e / e.sum(axis=1, keepdims=True)
    is_target = np.isin(x, x[:, 0])
    return -np.log(y[:, 0]).mean(), lambda dy: dy * (y - is_target) / len(x)


def binary_cross_entropy(y):
    """numpy-transformer: value and gradient, for the target 0.95, have 1e-8 at other places."""
    t = 0.95
    value = -(t * np.log(y + 1e-8) + (1 - t) * np.log(1 - y + 1e-8))
    return value, lambda dy: dy * ((1 - t) / (1 - (y + 1e-8)) - t / (y + 1e-8))


def gelu(x):
    """numpy-transformer: the constants of the gradient have six digits."""
    density = 0.398942 * np.exp(-x * x / 2)
    phi = 0.5 * (1 + erf(0.707107 * x))
    return x * 0.5 * (1 + erf(x / np.sqrt(2))), lambda dy: dy * (phi + x * density)


def recurrence(x, w):
    """rnn-from-scratch: the matrix that takes the gradient back is not transposed."""
    first = np.tanh(x)
    second = np.tanh(w @ first)

    def pullback(dy):
        d = dy * (1 - second**2)
        return (w @ d) * (1 - first**2), np.outer(d, first)

    return second, pullback


def largest(x):
    """dezero: each of several equal entries gets the whole gradient."""
    y = x.max(axis=1, keepdims=True)
    return y, lambda dy: dy * (x == y)


def quadratic(a, x):
    """pyproximal: Op x is the gradient of x' Op x / 2 for a symmetric Op only."""
    return x @ a @ x / 2, lambda dy: (dy * np.outer(x, x) / 2, dy * (a @ x))


def matern(theta):
    """scikit-learn's Matern(nu=1.3): a forward difference with a step of 1e-10."""

    def value(theta):
        return np.exp(-np.exp(theta)) * (1 + np.exp(theta))

    return value(theta), lambda dy: dy * (value(theta + 1e-10) - value(theta)) / 1e-10


BUGS = [
    (softmax, {"x": "batch features"}, "gradient for x", {}),
    (log_softmax, {"x": "batch features"}, "gradient for x", {}),
    (scores, {"q": "batch m d", "k": "batch n d"}, "gradient for k", {}),
    (layer_norm, {"x": "batch channels", "gamma": "channels"}, "gradient for x", {}),
    (cross_entropy, {"x": "batch classes"}, "ties", {}),
    (binary_cross_entropy, {"y": "batch"}, "gradient for y", {"values": {"y": (0.05, 0.95)}}),
    (gelu, {"x": "batch features"}, "gradient for x", {}),
    (recurrence, {"x": "hidden", "w": "hidden hidden"}, "gradient for x", {}),
    (largest, {"x": "batch c"}, "ties", {}),
    (quadratic, {"a": "n n", "x": "n"}, "gradient for x", {}),
    (matern, {"theta": "n"}, "gradient for theta", {"values": {"theta": (-2.0, 1.0)}}),
]


NAMES = [row[0].__name__ for row in BUGS]


@pytest.mark.parametrize(("f", "shapes", "found_by", "options"), BUGS, ids=NAMES)
def test_a_real_bug_is_found(f, shapes, found_by, options):
    sizes = dict.fromkeys({name for text in shapes.values() for name in text.split()}, (1, 2, 3, 5))
    assert found_by in failing(f, shapes, dtypes=("float64",), sizes=sizes, **options)
