"""Compare `check_gradients` with the checks of PyTorch, JAX and autograd, as far as installed.

Functions with pullbacks written in NumPy, right and wrong, are wrapped for each library and checked
with its default settings (in reverse mode, which alone uses the pullback). Thirty of them are ours;
the others were added after a reviewer had looked for weaknesses of `check_gradients`. Lists and
dicts of arrays are passed on to the libraries entry by entry, and numbers as arrays without axes.
docs/verify.md has the table that this prints:

    python docs/compare_gradient_checks.py
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from copy import deepcopy

import numpy as np

from numpy_cae import ops
from numpy_cae.verify import check_gradients
from numpy_cae.verify.checks.leaves import leaves, rebuilt

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


def by_numpy_cae(f: Callable, inputs: tuple) -> bool:
    try:
        check_gradients(f, *inputs)
    except (AssertionError, TypeError):  # a TypeError says that it cannot be checked
        return False
    return True


def by_torch(f: Callable, inputs: tuple) -> bool:
    import torch

    class Wrapped(torch.autograd.Function):
        @staticmethod
        def forward(context, *tensors):
            value, context.pullback = f(*(t.detach().numpy() for t in tensors))
            parts = value if isinstance(value, tuple) else (value,)
            made = tuple(torch.from_numpy(np.array(part)) for part in parts)
            return made if isinstance(value, tuple) else made[0]

        @staticmethod
        def backward(context, *dys):
            given = [dy.detach().numpy() for dy in dys]
            pulled = context.pullback(tuple(given) if len(given) > 1 else given[0])
            pulled = pulled if isinstance(pulled, tuple) else (pulled,)
            gradients = [torch.from_numpy(np.array(gradient)) for gradient in pulled]
            return (*gradients, *[None] * (len(inputs) - len(gradients)))

    tensors = [torch.from_numpy(np.array(x)) for x in inputs]
    tensors = [t.requires_grad_() if t.is_floating_point() else t for t in tensors]
    return torch.autograd.gradcheck(Wrapped.apply, tensors, raise_exception=False)


def by_jax(f: Callable, inputs: tuple) -> bool:
    import jax
    from jax.test_util import check_grads

    jax.config.update("jax_enable_x64", True)
    value = f(*inputs)[0]
    shapes = jax.tree.map(lambda y: jax.ShapeDtypeStruct(np.shape(y), np.asarray(y).dtype), value)
    floats = [x for x in inputs if np.issubdtype(x.dtype, np.floating)]
    others = inputs[len(floats) :]

    def value_of(*arrays):
        return f(*map(np.array, arrays), *others)[0]

    def pulled(dy, *arrays):
        made = f(*map(np.array, arrays), *others)[1](jax.tree.map(np.array, dy))
        return made[: len(arrays)] if isinstance(made, tuple) else (made,)

    @jax.custom_vjp
    def wrapped(*arrays):
        return jax.pure_callback(value_of, shapes, *arrays)

    def forward(*arrays):
        return wrapped(*arrays), arrays

    def backward(arrays, dy):
        like = tuple(jax.ShapeDtypeStruct(a.shape, a.dtype) for a in arrays)
        return jax.pure_callback(pulled, like, dy, *arrays)

    wrapped.defvjp(forward, backward)
    try:
        check_grads(wrapped, tuple(map(jax.numpy.asarray, floats)), order=1, modes=["rev"])
    except AssertionError:
        return False
    return True


def by_autograd(f: Callable, inputs: tuple) -> bool:
    from autograd.builtins import tuple as boxed_tuple
    from autograd.extend import defvjp, primitive
    from autograd.test_util import check_grads

    floats = [x for x in inputs if np.issubdtype(x.dtype, np.floating)]
    others = inputs[len(floats) :]
    is_tuple = isinstance(f(*inputs)[0], tuple)

    @primitive
    def wrapped(*arrays):
        value = f(*arrays, *others)[0]
        return boxed_tuple(value) if is_tuple else value

    def pulled(i: int) -> Callable:
        def of(value, *arrays):
            def pullback(dy):
                made = f(*arrays, *others)[1](dy)
                return made[i] if isinstance(made, tuple) else made

            return pullback

        return of

    defvjp(wrapped, *(pulled(i) for i in range(len(floats))))
    try:
        check_grads(wrapped, tuple(range(len(floats))), modes=["rev"], order=1)(*floats)
    except AssertionError:
        return False
    return True


def with_arrays(f: Callable, inputs: tuple) -> tuple[Callable, tuple]:
    """f as a function of the arrays and numbers in its inputs, one gradient for each of them."""
    arrays = [leaf for x in inputs for _, leaf in leaves("", x)]
    if all(isinstance(x, np.ndarray) for x in inputs):
        return f, inputs

    def of_arrays(*arrays):
        value, pullback = f(*rebuilt(inputs, iter(arrays)))
        return value, lambda dy: tuple(leaf for _, leaf in leaves("", pullback(dy)))

    return of_arrays, tuple(map(np.array, arrays))


CHECKS = {
    "check_gradients": by_numpy_cae,
    "gradcheck": by_torch,
    "jax": by_jax,
    "autograd": by_autograd,
}


def judged(check: Callable, case: tuple, is_right: bool) -> str:
    """What a check makes of a case."""
    f, *inputs = case
    np.random.seed(0)  # noqa: NPY002 (autograd draws from it)
    try:
        if check is not by_numpy_cae:
            f, inputs = with_arrays(f, tuple(inputs))
        passed = check(f, tuple(deepcopy(inputs)))
    except ImportError:
        return "not installed"
    except Exception as error:
        return type(error).__name__
    if passed == is_right:
        return "right"
    return "false alarm" if is_right else "missed"


def main() -> None:
    """Print the table, row by row, and how often each check was right."""
    warnings.simplefilter("ignore")
    print(f"| function | pullback | {' | '.join(CHECKS)} |\n|{'---|' * (2 + len(CHECKS))}")
    counts = dict.fromkeys(CHECKS, 0)
    for word, cases in (("right", RIGHT), ("wrong", WRONG)):
        for name, case in cases.items():
            verdicts = {n: judged(check, case, word == "right") for n, check in CHECKS.items()}
            for check, verdict in verdicts.items():
                counts[check] += verdict == "right"
            print(f"| {name} | {word} | {' | '.join(verdicts.values())} |", flush=True)
    total = len(RIGHT) + len(WRONG)
    print(f"| **right of {total}** | | {' | '.join(map(str, counts.values()))} |")


if __name__ == "__main__":
    main()
