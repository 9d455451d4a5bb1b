"""Real bugs of other projects, re-enacted: twenty operations, wrong as they were found and mended.

`verify.properties_of` found each in the project's own code, through an adapter of a few lines.
docs/wrong_gradients.md lists them with their links.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.special import erf

from studies.gradients.published import PublishedOperation

TRANSFORMER = "https://github.com/AkiRusProd/numpy-transformer"
NN_BY_NUMPY = "https://github.com/leeroee/NN-by-Numpy"
NUMPY_CNN = "https://github.com/ElefHead/numpy-cnn"
NUMPY_NN = "https://github.com/colecgulino/numpy-nn"

FOUND_BY: dict[str, str] = {}
"""The property that fails for each operation, by its name."""


def publish(
    function,
    link: str,
    mistake: str,
    shapes: Mapping[str, str],
    found_by: str,
    ranges: Mapping[str, tuple[float, ...]] | None = None,
) -> PublishedOperation:
    """An operation with its link, and the property that fails."""
    FOUND_BY[function.__name__] = found_by
    return PublishedOperation(
        project=link.rpartition("/")[2],
        operation=function.__name__,
        thread=link,
        fix="",
        mistake=mistake,
        shapes=shapes,
        function=function,
        ranges=ranges or {},
        dtypes=("float64",),
    )


def softmax(x, fixed):
    e = np.exp(x - x.max(axis=1, keepdims=True))
    y = e / e.sum(axis=1, keepdims=True)
    windows = 1 if fixed else len(x)
    return y, lambda dy: y * (dy - (y * dy).sum(axis=1, keepdims=True)) / windows


def log_softmax(x, fixed):
    e = np.exp(x - x.max(axis=1, keepdims=True))
    total = e.sum(axis=1, keepdims=True)
    windows = 1 if fixed else len(x)
    y = x - x.max(axis=1, keepdims=True) - np.log(total)
    return y, lambda dy: (dy - e / total * dy.sum(axis=1, keepdims=True)) / windows


def attention_scores(q, k, fixed):
    windows = 1 if fixed else len(q)

    def pullback(dy):
        return dy @ k / windows, dy.swapaxes(1, 2) @ q / windows

    return q @ k.swapaxes(1, 2), pullback


def layer_norm(x, gamma, fixed):
    centred = x - x.mean(axis=1, keepdims=True)
    size = np.sqrt((centred**2).mean(axis=1, keepdims=True) + 0.5)
    normal = centred / size

    def pullback(dy):
        dn = dy * gamma if fixed else dy
        along = (dn * normal).mean(axis=1, keepdims=True)
        dx = (dn - dn.mean(axis=1, keepdims=True) - normal * along) / size
        if not fixed:
            dx = gamma * dx
        return dx, (dy * normal).sum(axis=0)

    return gamma * normal, pullback


def cross_entropy(x, fixed):
    e = np.exp(x - x.max(axis=1, keepdims=True))
    y = e / e.sum(axis=1, keepdims=True)
    is_target = np.zeros(x.shape)
    is_target[:, 0] = 1
    if not fixed:
        is_target = np.isin(x, x[:, 0])
    return -np.log(y[:, 0]).mean(), lambda dy: dy * (y - is_target) / len(x)


def binary_cross_entropy(y, fixed):
    t = 0.95
    value = -(t * np.log(y + 1e-8) + (1 - t) * np.log(1 - y + 1e-8))
    rest = 1 - y + 1e-8 if fixed else 1 - (y + 1e-8)
    return value, lambda dy: dy * ((1 - t) / rest - t / (y + 1e-8))


def gelu(x, fixed):
    half = np.sqrt(0.5) if fixed else 0.707107
    height = 1 / np.sqrt(2 * np.pi) if fixed else 0.398942
    density = height * np.exp(-x * x / 2)
    phi = 0.5 * (1 + erf(half * x))
    return x * 0.5 * (1 + erf(x / np.sqrt(2))), lambda dy: dy * (phi + x * density)


def recurrence(x, w, fixed):
    first = np.tanh(x)
    second = np.tanh(w @ first)
    back = w.T if fixed else w

    def pullback(dy):
        d = dy * (1 - second**2)
        return (back @ d) * (1 - first**2), np.outer(d, first)

    return second, pullback


def largest(x, fixed):
    y = x.max(axis=1, keepdims=True)
    is_largest = x == y
    count = is_largest.sum(axis=1, keepdims=True) if fixed else 1
    return y, lambda dy: dy * is_largest / count


def quadratic(a, x, fixed):
    both = (a + a.T) / 2 if fixed else a
    return x @ a @ x / 2, lambda dy: (dy * np.outer(x, x) / 2, dy * (both @ x))


def matern(theta, fixed):
    def value(theta):
        return np.exp(-np.exp(theta)) * (1 + np.exp(theta))

    def slope():
        if fixed:
            return -np.exp(2 * theta - np.exp(theta))
        return (value(theta + 1e-10) - value(theta)) / 1e-10

    return value(theta), lambda dy: dy * slope()


def strided_convolution(x, w, fixed):
    taps = len(w)
    starts = range(0, len(x) - taps + 1, 2)
    y = np.array([x[start : start + taps] @ w for start in starts])

    def pullback(dy):
        dw = np.array([dy @ x[tap : tap + 2 * len(dy) : 2][: len(dy)] for tap in range(taps)])
        if not fixed:
            spaced = np.zeros(2 * len(dy) - 1)
            spaced[::2] = dy
            padded = np.pad(spaced, taps - 1)
            rows = range(0, len(padded) - taps + 1, 2)
            return np.array([padded[row : row + taps] @ w[::-1] for row in rows]), dw
        dx = np.zeros_like(x)
        for start, slope in zip(starts, dy, strict=True):
            dx[start : start + taps] += slope * w
        return dx, dw

    return y, pullback


def dropout(x, fixed):
    kept = np.arange(x.size).reshape(x.shape) % 3 > 0
    factor = 1 / (1 - 0.3)
    return x * kept * factor, lambda dy: dy * kept * (factor if fixed else 1)


def max_pooling(x, fixed):
    pairs = x.reshape(len(x), -1, 2)
    y = pairs.max(axis=2)

    def pullback(dy):
        if fixed:
            winner = pairs.argmax(axis=2)[..., None] == [0, 1]
        else:
            winner = pairs == y[..., None]
        return (winner * dy[..., None]).reshape(x.shape)

    return y, pullback


def squared_error(a, y, fixed):
    u = a - y
    factor = 2 if fixed else 1
    return np.mean(u * u), lambda dy: (dy * factor * u / u.size, -dy * factor * u / u.size)


def rectifier(x, fixed):
    def pullback(dy):
        if fixed:
            return np.where(x <= 0, 0, dy)
        dy[x <= 0] = 0
        return dy

    return np.maximum(x, 0), pullback


def softmax_of_logits(x, fixed):
    e = np.exp(x - x.max(axis=1, keepdims=True))
    y = e / e.sum(axis=1, keepdims=True)

    def pullback(dy):
        if fixed:
            return y * (dy - (y * dy).sum(axis=1, keepdims=True))
        return dy * x * (1 - x)

    return y, pullback


def fully_connected(x, w, b, fixed):
    windows = 1 if fixed else len(x)
    return x @ w + b, lambda dy: (dy @ w.T, x.T @ dy / windows, dy.sum(axis=0))


def softmax_jacobian(x, fixed):
    e = np.exp(x - x.max(axis=1, keepdims=True))
    y = e / e.sum(axis=1, keepdims=True)

    def pullback(dy):
        other = y[:, None, :] if fixed else y[:, :, None]
        jacobian = y[:, :, None] * (np.eye(x.shape[1]) - other)
        return np.einsum("nij,nj->ni", jacobian, dy)

    return y, pullback


def layer_norm_jacobian(x, gamma, fixed):
    size = np.sqrt(x.var(axis=1) + 0.5)
    normal = (x - x.mean(axis=1, keepdims=True)) / size[:, None]

    def pullback(dy):
        n = x.shape[1]
        outer = normal[:, :, None] * normal[:, None, :] / n
        jacobian = (np.eye(n) - 1 / n - outer) / size[:, None, None]
        jacobian = jacobian * (gamma if fixed else gamma[:, None])
        return np.einsum("nij,nj->ni", jacobian, dy), (dy * normal).sum(axis=0)

    return gamma * normal, pullback


ROWS = {"x": "batch features"}
REAL_BUGS = [
    publish(softmax, TRANSFORMER, "The gradient is divided by the batch.", ROWS, "gradient for x"),
    publish(
        log_softmax, TRANSFORMER, "The gradient is divided by the batch.", ROWS, "gradient for x"
    ),
    publish(
        attention_scores,
        TRANSFORMER,
        "The gradients for queries and keys are divided by the batch.",
        {"q": "batch m d", "k": "batch n d"},
        "gradient for k",
    ),
    publish(
        layer_norm,
        TRANSFORMER,
        "gamma stands before the bracket, not inside both sums.",
        {"x": "batch channels", "gamma": "channels"},
        "gradient for x",
    ),
    publish(
        cross_entropy,
        TRANSFORMER,
        "The target is found by its value: equal logits all count.",
        {"x": "batch classes"},
        "ties",
    ),
    publish(
        binary_cross_entropy,
        TRANSFORMER,
        "Value and gradient have 1e-8 at other places.",
        {"y": "batch"},
        "gradient for y",
        {"y": (0.05, 0.95)},
    ),
    publish(
        gelu, TRANSFORMER, "The constants of the gradient have six digits.", ROWS, "gradient for x"
    ),
    publish(
        recurrence,
        "https://github.com/vzhou842/rnn-from-scratch",
        "The matrix that takes the gradient back is not transposed.",
        {"x": "hidden", "w": "hidden hidden"},
        "gradient for x",
    ),
    publish(
        largest,
        "https://github.com/oreilly-japan/deep-learning-from-scratch-3",
        "Each of several equal entries gets the whole gradient.",
        {"x": "batch c"},
        "ties",
    ),
    publish(
        quadratic,
        "https://github.com/PyLops/pyproximal",
        "Op x is the gradient of x' Op x / 2 for a symmetric Op only.",
        {"a": "n n", "x": "n"},
        "gradient for x",
    ),
    publish(
        matern,
        "https://github.com/scikit-learn/scikit-learn",
        "A forward difference with a step of 1e-10.",
        {"theta": "n"},
        "gradient for theta",
        {"theta": (-2.0, 1.0)},
    ),
    publish(
        strided_convolution,
        NN_BY_NUMPY,
        "The way back steps by the stride, too: the gradient has another shape.",
        {"x": "4*frames", "w": "3"},
        "gradient for x",
    ),
    publish(
        dropout,
        NN_BY_NUMPY,
        "The factor 1 / (1 - p) of the value is missing.",
        {"x": "batch channels"},
        "gradient for x",
    ),
    publish(
        max_pooling,
        NN_BY_NUMPY,
        "Each of several equal entries gets the whole gradient.",
        {"x": "batch 2*frames"},
        "ties",
    ),
    publish(
        squared_error,
        NN_BY_NUMPY,
        "The factor 2 of the derivative is missing.",
        {"a": "batch channels", "y": "batch channels"},
        "gradient for a",
    ),
    publish(rectifier, NN_BY_NUMPY, "The upstream gradient is overwritten.", ROWS, "purity"),
    publish(
        softmax_of_logits,
        NUMPY_CNN,
        "The derivative is that of one entry, taken at the argument.",
        ROWS,
        "gradient for x",
    ),
    publish(
        fully_connected,
        NUMPY_CNN,
        "The weights' gradient is a mean over the batch, the bias's a sum.",
        {"x": "batch in", "w": "in out", "b": "out"},
        "gradient for w",
    ),
    publish(
        softmax_jacobian,
        NUMPY_NN,
        "The matrix has y_i for y_j in its product.",
        ROWS,
        "gradient for x",
    ),
    publish(
        layer_norm_jacobian,
        NUMPY_NN,
        "gamma multiplies the rows of the matrix, not its columns.",
        {"x": "batch channels", "gamma": "channels"},
        "gradient for x",
    ),
]
"""The operations, project by project."""
