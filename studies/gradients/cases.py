"""Functions with pullbacks in NumPy, 22 right and 30 wrong, for the study `gradient_checks`.

Thirty of them are ours; the others were added after a reviewer had looked for weaknesses of
`check_gradients`. A case is an operation and its arguments.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae import ops

RNG = np.random.default_rng(0)
NORMAL = RNG.standard_normal((3, 4))
CONVOLUTION = [RNG.standard_normal(shape) for shape in ((2, 6, 3), (3, 3, 2), (2,))]
GRU = [RNG.standard_normal(s) for s in ((2, 3), (2, 4), (3, 12), (4, 12), (12,), (12,))]
PLACES = np.array([0, 2, 2, 1])
MIXED = np.array([1e-3, 1e4, 1.0])
WITH_ZERO = np.array([[0.0, 1.0], [-0.5, 2.0]])
SINGLE = NORMAL.astype(np.float32)
LAYERS = RNG.standard_normal((4, 3)), RNG.standard_normal((3, 2))
WEIGHTS = {"w": LAYERS[0], "b": RNG.standard_normal(3)}
MANY = RNG.standard_normal(2_000)
TEN_MILLIONTH = np.array([1e-8, 1.0])


def of(f: Callable, slope: Callable, x: np.ndarray, pulled: Callable = np.positive) -> tuple:
    """The case of a function of numbers and its derivative, by which `pulled(dy)` is multiplied."""
    return (lambda x: (f(x), lambda dy: pulled(dy) * slope(x))), x


def twice(x):
    return 2 * x


def too_steep(x):
    return np.where(x < 0.1, 4 * x, 2 * x)


def tanh_slope(x):
    return 1 - np.tanh(x) ** 2


def sigmoid(x):
    return 1 / (1 + np.exp(-x))


def tail_doubled(x):
    return sigmoid(x) * sigmoid(-x) * np.where(x < -10, 2, 1)


def one_off(at: int) -> Callable:
    def slope(x):
        return 2 * x * np.where(np.arange(x.size) == at, 1.5, 1.0)

    return slope


def with_pullback(operation: Callable, change: Callable) -> Callable:
    """An operation whose gradients are changed: `change` gets what its pullback returns, and dy."""

    def changed(*inputs):
        value, pullback = operation(*inputs)
        return value, lambda dy: change(pullback(dy), dy)

    return changed


def sum_and_square(second: float = 1.0, scale: float = 1.0, axis: int | None = 0) -> Callable:
    """Two outputs, scale Σ x and x² or, where the axis is None, Σ x²."""

    def f(x):
        squares = x * x if axis == 0 else np.sum(x * x)
        value = scale * x.sum(axis=axis), squares
        return value, lambda dy: scale * dy[0] + second * 2 * x * dy[1]

    return f


def gather(accumulate: bool = True) -> Callable:
    def f(x, places):
        def pullback(dy):
            dx = np.zeros_like(x)
            if accumulate:
                np.add.at(dx, places, dy)
            else:
                dx[places] = dy
            return dx

        return x[places], pullback

    return f


def noisy(x):
    y = x * (np.random.default_rng().random(x.shape) < 0.5)
    return y, lambda dy: dy * (y != 0)


def altering(dy):
    dy *= 0.5
    return 2 * dy


def ties_to_both(x):
    y, _ = ops.max_pool(x)
    return y, lambda dy: np.repeat(dy, 2, axis=1) * (x == np.repeat(y, 2, axis=1))


def stateful(change: Callable) -> tuple:
    """tanh, whose pullback keeps something: `change` gets dx, and a dict for each call of tanh."""

    def f(x):
        y = np.tanh(x)
        memory = {}
        return y, lambda dy: change(dy * (1 - y * y), memory)

    return f, NORMAL


def accumulating(dx, memory):
    memory["sum"] = memory.get("sum", 0) + dx
    return memory["sum"]


def popping(dx, memory):
    stack = memory.setdefault("stack", [1.0, 1.0])
    return dx * (stack.pop() if stack else 0.0) if len(stack) == 2 else 0 * dx


def doubling(dx, memory):
    memory["factor"] = 2 * memory.get("factor", 0.5)
    return dx * memory["factor"]


def one_buffer(dx, memory):
    buffer = memory.setdefault("dx", np.empty_like(dx))
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
        def pullback(dy):
            return dy @ weights["w"].T, {"w": factor * x.T @ dy, "b": dy.sum(axis=0)}

        return x @ weights["w"] + weights["b"], pullback

    return f


def scaled(factor: float = 1.0) -> Callable:
    return lambda x, scale: (scale * x, lambda dy: (scale * dy, factor * np.sum(x * dy)))


def total(slope: Callable) -> tuple:
    return (lambda x: (np.sum(x * x), lambda dy: dy * slope(x))), MIXED


def raised_total(x):
    return np.sum(np.tanh(x)) + 1e8, lambda dy: dy * tanh_slope(x)


def times_integers(x, n):
    return x * n, lambda dy: (dy * n, dy * 99)


RIGHT = {
    "conv1d": (ops.conv1d, *CONVOLUTION),
    "gru_step": (ops.gru_step, *GRU),
    "x², entries 1e-3, 1e4 and 1": of(np.square, twice, MIXED),
    "Σ x², the same": total(twice),
    "log, entries 1e-8 and 1": of(np.log, np.reciprocal, TEN_MILLIONTH),
    "√x at 1e-10": of(np.sqrt, lambda x: 0.5 / np.sqrt(x), np.array([1e-10, 1.0])),
    "arctanh at 0.99999": (lambda y: ops.arctanh(y, 0.999999), np.array([0.5, 0.99999])),
    "exp at 30": of(np.exp, np.exp, np.array([30.0, -1.0])),
    "sin(1000 x)": of(lambda x: np.sin(1e3 * x), lambda x: 1e3 * np.cos(1e3 * x), NORMAL),
    "sin(x / 1e-9)": of(
        lambda x: np.sin(x / 1e-9), lambda x: np.cos(x / 1e-9) / 1e-9, 1e-9 * NORMAL
    ),
    "tanh(x) + 1e6": of(lambda x: np.tanh(x) + 1e6, tanh_slope, NORMAL),
    "tanh in float32": of(np.tanh, tanh_slope, SINGLE),
    "abs(x), one entry 0": of(np.abs, np.sign, WITH_ZERO),
    "two outputs": (sum_and_square(), NORMAL),
    "x[places], integers": (gather(), NORMAL, PLACES),
    "weights in a list": (layers(), NORMAL, [*LAYERS]),
    "weights in a dict": (affine(), NORMAL, WEIGHTS),
    "scale · x, scale a number": (scaled(), NORMAL, 0.7),
    "1e6 Σ x and Σ x²": (sum_and_square(1.0, 1e6, None), NORMAL),
    "Σ tanh(x) + 1e8": (raised_total, NORMAL),
    "relu, slope 0.7 at 0": of(
        lambda x: np.maximum(x, 0), lambda x: np.where(x == 0, 0.7, x > 0), WITH_ZERO
    ),
    "x² of 2000 entries": of(np.square, twice, MANY),
}
WRONG = {
    "conv1d, db a mean": (
        with_pullback(ops.conv1d, lambda g, dy: (g[0], g[1], dy.mean(axis=(0, 1)))),
        *CONVOLUTION,
    ),
    "linear, x and w exchanged": (
        with_pullback(ops.linear, lambda g, dy: (g[1], g[0], g[2])),
        *(np.eye(3), RNG.standard_normal((3, 3)), np.ones(3)),
    ),
    "x², slope doubled at 1e-3": of(np.square, too_steep, MIXED),
    "Σ x², the same": total(too_steep),
    "log, slope halved at 1e-8": of(np.log, lambda x: (0.5 + (x > 0.1) / 2) / x, TEN_MILLIONTH),
    "sigmoid, tail doubled at -15": of(sigmoid, tail_doubled, np.array([-15.0, 1.0])),
    "sin, slope off by 1e-4": of(np.sin, lambda x: np.cos(x) * (1 + 1e-4), NORMAL),
    "x², 1 of 1000 entries": of(np.square, one_off(7), RNG.standard_normal(1000)),
    "tanh in float32, off by 1e-3": of(np.tanh, lambda x: 1.001 * tanh_slope(x), SINGLE),
    "abs(x), slope 3 at 0": of(np.abs, lambda x: np.where(x == 0, 3, np.sign(x)), WITH_ZERO),
    "max_pool, ties to both": (ties_to_both, np.repeat(NORMAL[:, ::2, None], 2, axis=1)),
    "two outputs, the second halved": (sum_and_square(0.5), NORMAL),
    "x[places], not accumulated": (gather(False), NORMAL, PLACES),
    "random values": (noisy, NORMAL),
    "dy altered": of(np.tanh, tanh_slope, NORMAL, altering),
    "dx added up over calls": stateful(accumulating),
    "a stack popped by the first call": stateful(popping),
    "a factor doubled by each call": stateful(doubling),
    "the first dx returned again": stateful(lambda dx, memory: memory.setdefault("dx", dx)),
    "every dx in one buffer": stateful(one_buffer),
    "dy clipped to ±3": of(np.tanh, tanh_slope, NORMAL, lambda dy: np.clip(dy, -3, 3)),
    "the size of dy in place of dy": of(np.tanh, tanh_slope, NORMAL, np.abs),
    "weights in a list, dw tripled": (layers(3.0), NORMAL, [*LAYERS]),
    "weights in a dict, dw tripled": (affine(3.0), NORMAL, WEIGHTS),
    "scale · x, its gradient times 5": (scaled(5.0), NORMAL, 0.7),
    "x · n, a gradient for integers n": (times_integers, NORMAL, np.array([1, 2, 3, 4])),
    "1e6 Σ x and Σ x², 20% off": (sum_and_square(0.8, 1e6, None), NORMAL),
    "i x³, gradient 0": of(lambda x: 1j * x**3, np.zeros_like, NORMAL, np.real),
    "c x, c not conjugated": (lambda x: (0.7j * x + x, lambda dy: (dy * (1 + 0.7j)).real), NORMAL),
    "x², 1 of 2000 entries": of(np.square, one_off(1_234), MANY),
}
