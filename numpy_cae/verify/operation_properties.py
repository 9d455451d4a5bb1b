"""Properties of single operations: shifts, ties, empty slots, bounds, order, time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from scipy.optimize import linear_sum_assignment

from numpy_cae import ops
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.convention import gru_step_in
from numpy_cae.verify.operation import Operation
from numpy_cae.verify.property import Property, drawn_upstream, require_equal

LARGE = 1000.0
WIDE_BOUND = 0.99

_STATED: dict[str, list[Callable[[Operation], Property]]] = {}
"""For each operation, what makes its properties."""


def operation_properties(operation: Operation) -> Iterator[Property]:
    """The properties that only this operation has."""
    for stated in _STATED.get(operation.name, ()):
        yield stated(operation)


def states(name: str, statement: str, *operations: str, **sizes: tuple[int, ...]) -> Callable:
    """Make a check a property of operations, tried at `sizes` in place of the operation's own."""

    def register(check: Callable[[Operation, Callable, Case], None]) -> Callable:
        def stated(operation: Operation) -> Property:
            return Property(
                operation.name,
                name,
                statement,
                partial(check, operation),
                operation.arguments,
                {**operation.sizes, **sizes},
            )

        for operation in operations:
            _STATED.setdefault(operation, []).append(stated)
        return check

    return register


def _only(pulled) -> np.ndarray:
    return pulled[0] if isinstance(pulled, tuple | list) else pulled


@states(
    "shift in time",
    "away from the edges, a frame's delay of x delays y by a frame",
    "conv1d",
    frames=(8, 9, 10),
    taps=(1, 3, 5),
)
def _shift(operation: Operation, conv1d: Callable, case: Case) -> None:
    x, w, b = operation.arguments(case).values()
    beyond = case["taps"] // 2
    middle = slice(beyond, case["frames"] - beyond - 1)
    shifted = np.roll(x, 1, axis=1)
    later = conv1d(shifted, w, b)[0][:, beyond + 1 : case["frames"] - beyond]
    require_equal("one frame later, the value", later, conv1d(x, w, b)[0][:, middle])


@states("own inverse", "transposing twice changes nothing", "transpose_filters")
def _own_inverse(operation: Operation, transpose_filters: Callable, case: Case) -> None:
    (w,) = operation.arguments(case).values()
    require_equal("transposed twice, the bank", transpose_filters(transpose_filters(w)[0])[0], w)


@states("ties", "a tie goes to the earlier frame, value and whole gradient", "max_pool")
def _ties(operation: Operation, max_pool: Callable, case: Case) -> None:
    (x,) = operation.arguments(case).values()
    tied = np.repeat(x[:, ::2], 2, axis=1)
    value, pullback = max_pool(tied)
    require_equal("the larger of two equal frames", value, x[:, ::2])
    dy = drawn_upstream(case, value)
    dx = _only(pullback(dy))
    require_equal("of a tie, the earlier frame's gradient", dx[:, 0::2], dy)
    require_equal("of a tie, the later frame's gradient", dx[:, 1::2], np.zeros_like(dy), 0)


@states("loser", "the smaller frame's gradient is exactly 0", "max_pool")
def _loser_gets_nothing(operation: Operation, max_pool: Callable, case: Case) -> None:
    (x,) = operation.arguments(case).values()
    value, pullback = max_pool(x)
    dx = _only(pullback(drawn_upstream(case, value)))
    lost = x < np.repeat(value, 2, axis=1)
    require_equal("the smaller frames' gradient", dx[lost], np.zeros(lost.sum()), 0)


@states("pair sums", "both frames of a pair sum to y", "unpool_even", "unpool_random")
def _pair_sums(operation: Operation, unpool: Callable, case: Case) -> None:
    arguments = operation.arguments(case)
    x, _ = unpool(*arguments.values())
    require_equal("the sum of a pair", x[:, 0::2] + x[:, 1::2], arguments["y"])


@states("empty slot", "the other frame of the pair is exactly 0", "unpool_random")
def _empty_slot(operation: Operation, unpool_random: Callable, case: Case) -> None:
    y, first = operation.arguments(case).values()
    x, _ = unpool_random(y, first)
    other = np.where(first, x[:, 1::2], x[:, 0::2])
    if np.any(other != 0):
        raise AssertionError(
            f"the other frame of the pair is {other[other != 0][0]}, not exactly 0"
        )


@states(
    "large inputs",
    "at ±1000 it is saturated: its limits, a gradient of 0, no overflow into nan",
    "tanh",
    "sigmoid",
)
def _saturation(operation: Operation, activation: Callable, case: Case) -> None:
    (x,) = operation.arguments(case).values()
    lowest = 0.0 if operation.name == "sigmoid" else -1.0
    with np.errstate(over="ignore"):
        value, pullback = activation(LARGE * np.sign(x))
        require_equal("at ±1000 the value", value, np.where(x > 0, 1.0, lowest))
        dx = _only(pullback(drawn_upstream(case, value)))
    require_equal("at ±1000 the gradient", dx, np.zeros_like(x))


@states(
    "inverse of tanh",
    "arctanh ∘ tanh is the identity inside the bound, its derivative too",
    "arctanh",
)
def _inverse_of_tanh(operation: Operation, arctanh: Callable, case: Case) -> None:
    x = spread(case.rng(), operation.arguments(case)["y"].shape, np.arctanh(WIDE_BOUND) * 0.999)
    y, tanh_pullback = ops.tanh(x)
    back, pullback = arctanh(y, WIDE_BOUND)
    require_equal("arctanh(tanh(x))", back, x)
    dx = drawn_upstream(case, x)
    require_equal("through arctanh and tanh, the gradient", tanh_pullback(_only(pullback(dx))), dx)


@states(
    "beyond the bound",
    "beyond the bound the value is arctanh(±bound) and the gradient exactly 0",
    "arctanh",
)
def _beyond_the_bound(operation: Operation, arctanh: Callable, case: Case) -> None:
    y, bound = operation.arguments(case).values()
    outside = np.sign(y) * (bound + np.abs(y))
    value, pullback = arctanh(outside, bound)
    require_equal("beyond the bound the value", value, np.sign(y) * np.arctanh(bound))
    dy = _only(pullback(drawn_upstream(case, value)))
    require_equal("beyond the bound the gradient", dy, np.zeros_like(y), 0)


@states("rows alone", "each row is mapped as if it were alone", "linear")
def _rows_alone(operation: Operation, linear: Callable, case: Case) -> None:
    x, w, b = operation.arguments(case).values()
    rows = x.reshape(-1, x.shape[-1])
    alone = np.stack([linear(row, w, b)[0] for row in rows]).reshape(*x.shape[:-1], -1)
    require_equal("of all rows at once the value", linear(x, w, b)[0], alone)


@states("repeated gru_step", "value and gradients are those of gru_step, repeated", "gru")
def _steps(operation: Operation, gru: Callable, case: Case) -> None:
    x, h, *weights = operation.arguments(case).values()
    step = gru_step_in(operation.convention)
    value, pullback = gru(x, h, *weights)
    dy = drawn_upstream(case, value)
    pullbacks = []
    for t in range(x.shape[1]):
        h, step_pullback = step(x[:, t], h, *weights)
        require_equal(f"the value of frame {t}", value[:, t], h)
        pullbacks.append(step_pullback)
    dh, dx, totals = np.zeros_like(h), np.zeros_like(x), [np.zeros_like(w) for w in weights]
    for t in reversed(range(x.shape[1])):
        dx[:, t], dh, *terms = pullbacks[t](dy[:, t] + dh)
        totals = [total + term for total, term in zip(totals, terms, strict=True)]
    for name, found, expected in zip(
        operation.differentiated, pullback(dy), (dx, dh, *totals), strict=True
    ):
        require_equal(f"the gradient for {name}", found, expected)


@states("causality", "no frame depends on a later one", "gru", frames=(2, 3, 4))
def _causality(operation: Operation, gru: Callable, case: Case) -> None:
    x, *others = operation.arguments(case).values()
    earlier, _ = gru(x[:, :-1], *others)
    require_equal("of the earlier frames alone the value", earlier, gru(x, *others)[0][:, :-1])


@states("kept state", "a sequence in two pieces is the whole one", "gru", frames=(2, 3, 4))
def _kept_state(operation: Operation, gru: Callable, case: Case) -> None:
    x, h0, *weights = operation.arguments(case).values()
    whole, _ = gru(x, h0, *weights)
    head, _ = gru(x[:, :1], h0, *weights)
    tail, _ = gru(x[:, 1:], head[:, -1], *weights)
    require_equal("in two pieces the value", np.concatenate([head, tail], axis=1), whole)


@states(
    "zero at the target",
    "where x_hat equals x, loss and gradient are exactly 0",
    "mean_squared_error",
)
def _zero_at_the_target(operation: Operation, mean_squared_error: Callable, case: Case) -> None:
    _, x = operation.arguments(case).values()
    loss, pullback = mean_squared_error(x.copy(), x)
    require_equal("at the target the loss", loss, 0.0, 0)
    require_equal("at the target the gradient", _only(pullback(1.0)), np.zeros_like(x), 0)


@states("zero at zero", "at y = 0 the gradient is exactly 0", "mean_absolute")
def _zero_at_zero(operation: Operation, mean_absolute: Callable, case: Case) -> None:
    (y,) = operation.arguments(case).values()
    _, pullback = mean_absolute(np.where(y > 0, y, 0.0))
    dy = _only(pullback(1.0))
    require_equal("at 0 the gradient", dy[y < 0], np.zeros(np.sum(y < 0)), 0)


@states("equal sets", "between equal sets distance and gradient are 0", "sliced_wasserstein")
def _equal_sets(operation: Operation, sliced_wasserstein: Callable, case: Case) -> None:
    z, _, directions = operation.arguments(case).values()
    loss, pullback = sliced_wasserstein(case.rng().permutation(z), z, directions)
    require_equal("between equal sets the distance", loss, 0.0)
    require_equal("between equal sets the gradient", _only(pullback(1.0)), np.zeros_like(z))


@states("order", "the order of the points does not matter", "sliced_wasserstein")
def _order(operation: Operation, sliced_wasserstein: Callable, case: Case) -> None:
    z, prior, directions = operation.arguments(case).values()
    order = case.rng().permutation(len(z))
    loss, pullback = sliced_wasserstein(z, prior, directions)
    again, pullback_again = sliced_wasserstein(z[order], prior[order[::-1]], directions)
    require_equal("in another order the distance", again, loss)
    require_equal(
        "in another order the gradient", _only(pullback_again(1.0)), _only(pullback(1.0))[order]
    )


@states(
    "optimal assignment",
    "in one dimension it is the cheapest assignment on squared costs, mean over points",
    "sliced_wasserstein",
    dimensions=(1,),
)
def _assignment(operation: Operation, sliced_wasserstein: Callable, case: Case) -> None:
    z, prior, _ = operation.arguments(case).values()
    cost = (z - prior.T) ** 2
    rows, columns = linear_sum_assignment(cost)
    loss, _ = sliced_wasserstein(z, prior, np.ones((1, 1)))
    require_equal("the distance", loss, cost[rows, columns].mean())


@states(
    "upstream default",
    "called without the upstream number, the pullback takes it to be 1",
    "mean_squared_error",
    "mean_absolute",
    "sliced_wasserstein",
)
def _one_by_default(operation: Operation, loss: Callable, case: Case) -> None:
    _, pullback = loss(*operation.arguments(case).values())
    require_equal("by default the gradient", _only(pullback()), _only(pullback(1.0)), 0)
