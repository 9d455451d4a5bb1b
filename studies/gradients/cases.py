"""Functions with pullbacks in NumPy, 22 right and 30 wrong, for the study `gradient_checks`.

Thirty of them are ours; the others were added after a reviewer had looked for weaknesses of
`check_gradients`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae import ops

RNG = np.random.default_rng(0)
NORMAL = RNG.standard_normal((3, 4))
X, W, B = RNG.standard_normal((2, 6, 3)), RNG.standard_normal((3, 3, 2)), RNG.standard_normal(2)
GRU = [RNG.standard_normal(s) for s in ((2, 3), (2, 4), (3, 12), (4, 12), (12,), (12,))]
PLACES = np.array([0, 2, 2, 1])
MIXED = np.array([1e-3, 1e4, 1.0])


def elementwise(f: Callable, slope: Callable) -> Callable:
    """An operation from a function of numbers and its derivative."""
    return lambda x: (f(x), lambda dy: dy * slope(x))


def total_of_squares(slope: Callable = lambda x: 2 * x) -> Callable:
    return lambda x: (np.sum(x * x), lambda dy: dy * slope(x))


def with_pullback(operation: Callable, change: Callable) -> Callable:
    """An operation whose gradients are changed: `change` gets what its pullback returns, and dy."""

    def changed(*inputs):
        value, pullback = operation(*inputs)
        return value, lambda dy: change(pullback(dy), dy)

    return changed


def one_off(dx, dy):
    dx.flat[7] *= 1.5
    return dx


def sum_and_square(second: float = 1.0) -> Callable:
    def f(x):
        return (x.sum(axis=0), x * x), lambda dy: dy[0] + second * 2 * x * dy[1]

    return f


def gather(x, places, accumulate=True):
    def pullback(dy):
        dx = np.zeros_like(x)
        if accumulate:
            np.add.at(dx, places, dy)
        else:
            dx[places] = dy
        return dx

    return x[places], pullback


def masked(x, mask):
    return np.where(mask, np.sin(x), 0.0), lambda dy: np.where(mask, dy * np.cos(x), 0.0)


def noisy(x):
    y = x * (np.random.default_rng().random(x.shape) < 0.5)
    return y, lambda dy: dy * (y != 0)


def altering(x):
    y = np.tanh(x)

    def pullback(dy):
        dy *= 1 - y * y
        return dy

    return y, pullback


def ties_to_both(x):
    y, _ = ops.max_pool(x)
    return y, lambda dy: np.repeat(dy, 2, axis=1) * (x == np.repeat(y, 2, axis=1))


def stateful(change: Callable) -> Callable:
    """tanh, whose pullback keeps something: `change` gets dx, and a dict for each call of tanh."""

    def f(x):
        y, kept = np.tanh(x), {}
        return y, lambda dy: change(dy * (1 - y * y), kept)

    return f


def accumulating(dx, kept):
    kept["sum"] = kept.get("sum", 0) + dx
    return kept["sum"]


def popping(dx, kept):
    stack = kept.setdefault("stack", [1.0, 1.0])
    return dx * (stack.pop() if stack else 0.0) if len(stack) == 2 else 0 * dx


def doubling(dx, kept):
    kept["factor"] = 2 * kept.get("factor", 0.5)
    return dx * kept["factor"]


def first_kept(dx, kept):
    return kept.setdefault("dx", dx)


def one_buffer(dx, kept):
    buffer = kept.setdefault("dx", np.empty_like(dx))
    buffer[...] = dx
    return buffer


def layers(factor: float = 1.0) -> Callable:
    """Two linear maps: f(x, [w, v])."""

    def f(x, weights):
        w, v = weights
        h = x @ w
        return h @ v, lambda dy: (dy @ v.T @ w.T, [factor * x.T @ (dy @ v.T), h.T @ dy])

    return f


def affine(factor: float = 1.0) -> Callable:
    """f(x, {"w": w, "b": b})."""

    def f(x, weights):
        w, b = weights["w"], weights["b"]
        back = lambda dy: (dy @ w.T, {"w": factor * x.T @ dy, "b": dy.sum(axis=0)})  # noqa: E731
        return x @ w + b, back

    return f


def scaled(factor: float = 1.0) -> Callable:
    return lambda x, scale: (scale * x, lambda dy: (scale * dy, factor * np.sum(x * dy)))


def two_sizes(second: float = 1.0) -> Callable:
    def f(x):
        back = lambda dy: 1e6 * dy[0] + second * 2 * x * dy[1]  # noqa: E731
        return (1e6 * x.sum(), np.sum(x * x)), back

    return f


def cubes_with_an_i(x):
    return 1j * x**3, lambda dy: np.zeros_like(x)


def not_conjugated(x):
    c = 0.3 + 0.7j
    return c * x, lambda dy: np.real(c * dy)


def one_of_many(x):
    slope = 2 * x
    slope[1_234] *= 0.75
    return x * x, lambda dy: dy * slope


def tanh_slope(x):
    return 1 - np.tanh(x) ** 2


def sigmoid(x):
    return 1 / (1 + np.exp(-x))


def tail_doubled(x):
    return sigmoid(x) * sigmoid(-x) * np.where(x < -10, 2, 1)


SQUARE, LOG = np.square, np.log
WITH_ZERO = np.array([[0.0, 1.0], [-0.5, 2.0]])
LAYERS = RNG.standard_normal((4, 3)), RNG.standard_normal((3, 2))
WEIGHTS = {"w": LAYERS[0], "b": RNG.standard_normal(3)}
MANY = RNG.standard_normal(2_000)
RIGHT = {
    "conv1d": (ops.conv1d, X, W, B),
    "gru_step": (ops.gru_step, *GRU),
    "x², entries 1e-3, 1e4 and 1": (elementwise(SQUARE, lambda x: 2 * x), MIXED),
    "Σ x², the same": (total_of_squares(), MIXED),
    "log, entries 1e-8 and 1": (elementwise(LOG, lambda x: 1 / x), np.array([1e-8, 1.0])),
    "√x at 1e-10": (elementwise(np.sqrt, lambda x: 0.5 / np.sqrt(x)), np.array([1e-10, 1.0])),
    "arctanh at 0.99999": (lambda y: ops.arctanh(y, 0.999999), np.array([0.5, 0.99999])),
    "exp at 30": (elementwise(np.exp, np.exp), np.array([30.0, -1.0])),
    "sin(1000 x)": (
        elementwise(lambda x: np.sin(1e3 * x), lambda x: 1e3 * np.cos(1e3 * x)),
        NORMAL,
    ),
    "sin(x / 1e-9)": (
        elementwise(lambda x: np.sin(x / 1e-9), lambda x: np.cos(x / 1e-9) / 1e-9),
        1e-9 * NORMAL,
    ),
    "tanh(x) + 1e6": (elementwise(lambda x: np.tanh(x) + 1e6, tanh_slope), NORMAL),
    "tanh in float32": (elementwise(np.tanh, tanh_slope), NORMAL.astype(np.float32)),
    "abs(x), one entry 0": (elementwise(np.abs, np.sign), WITH_ZERO),
    "two outputs": (sum_and_square(), NORMAL),
    "x[places], integers": (gather, NORMAL, PLACES),
    "weights in a list": (layers(), NORMAL, [*LAYERS]),
    "weights in a dict": (affine(), NORMAL, WEIGHTS),
    "scale · x, scale a number": (scaled(), NORMAL, 0.7),
    "1e6 Σ x and Σ x²": (two_sizes(), NORMAL),
    "Σ tanh(x) + 1e8": (
        lambda x: (np.sum(np.tanh(x)) + 1e8, lambda dy: dy * tanh_slope(x)),
        NORMAL,
    ),
    "relu, slope 0.7 at 0": (
        elementwise(lambda x: np.maximum(x, 0), lambda x: np.where(x == 0, 0.7, x > 0)),
        WITH_ZERO,
    ),
    "x² of 2000 entries": (elementwise(SQUARE, lambda x: 2 * x), MANY),
}
WRONG = {
    "conv1d, db a mean": (
        with_pullback(ops.conv1d, lambda g, dy: (g[0], g[1], dy.mean(axis=(0, 1)))),
        X,
        W,
        B,
    ),
    "linear, x and w exchanged": (
        with_pullback(ops.linear, lambda g, dy: (g[1], g[0], g[2])),
        np.eye(3),
        W[0] @ W[1].T,
        W[0, 0, 0] * np.ones(3),
    ),
    "x², slope doubled at 1e-3": (
        elementwise(SQUARE, lambda x: np.where(x < 0.1, 4 * x, 2 * x)),
        MIXED,
    ),
    "Σ x², the same": (total_of_squares(lambda x: np.where(x < 0.1, 4 * x, 2 * x)), MIXED),
    "log, slope halved at 1e-8": (
        elementwise(LOG, lambda x: np.where(x < 0.1, 0.5 / x, 1 / x)),
        np.array([1e-8, 1.0]),
    ),
    "sigmoid, tail doubled at -15": (elementwise(sigmoid, tail_doubled), np.array([-15.0, 1.0])),
    "sin, slope off by 1e-4": (elementwise(np.sin, lambda x: np.cos(x) * (1 + 1e-4)), NORMAL),
    "x², 1 of 1000 entries": (
        with_pullback(elementwise(SQUARE, lambda x: 2 * x), one_off),
        RNG.standard_normal(1000),
    ),
    "tanh in float32, off by 1e-3": (
        elementwise(np.tanh, lambda x: 1.001 * tanh_slope(x)),
        NORMAL.astype(np.float32),
    ),
    "abs(x), slope 3 at 0": (
        elementwise(np.abs, lambda x: np.where(x == 0, 3.0, np.sign(x))),
        WITH_ZERO,
    ),
    "max_pool, ties to both": (ties_to_both, np.repeat(NORMAL[:, ::2, None], 2, axis=1)),
    "two outputs, the second halved": (sum_and_square(0.5), NORMAL),
    "x[places], not accumulated": (lambda x, p: gather(x, p, False), NORMAL, PLACES),
    "random values": (noisy, NORMAL),
    "dy altered": (altering, NORMAL),
    "dx added up over calls": (stateful(accumulating), NORMAL),
    "a stack popped by the first call": (stateful(popping), NORMAL),
    "a factor doubled by each call": (stateful(doubling), NORMAL),
    "the first dx returned again": (stateful(first_kept), NORMAL),
    "every dx in one buffer": (stateful(one_buffer), NORMAL),
    "dy clipped to ±3": (
        lambda x: (np.tanh(x), lambda dy: np.clip(dy, -3, 3) * tanh_slope(x)),
        NORMAL,
    ),
    "the size of dy in place of dy": (
        lambda x: (np.tanh(x), lambda dy: np.abs(dy) * tanh_slope(x)),
        NORMAL,
    ),
    "weights in a list, dw tripled": (layers(3.0), NORMAL, [*LAYERS]),
    "weights in a dict, dw tripled": (affine(3.0), NORMAL, WEIGHTS),
    "scale · x, its gradient times 5": (scaled(5.0), NORMAL, 0.7),
    "x · n, a gradient for integers n": (
        lambda x, n: (x * n, lambda dy: (dy * n, dy * 99)),
        NORMAL,
        np.array([1, 2, 3, 4]),
    ),
    "1e6 Σ x and Σ x², 20% off": (two_sizes(0.8), NORMAL),
    "i x³, gradient 0": (cubes_with_an_i, NORMAL),
    "c x, c not conjugated": (not_conjugated, NORMAL),
    "x², 1 of 2000 entries": (one_of_many, MANY),
}
