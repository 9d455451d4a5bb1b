"""Properties of single operations: shifts, ties, empty slots, bounds, order, time.

Where a property says what the definition returns for one class of values, it is a row of
`COMPARED`; the others are functions below.
"""

from collections.abc import Callable, Iterator
from itertools import permutations

import numpy as np

from numpy_cae import ops
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.operation import TIED, WITHOUT_TIES, Operation
from numpy_cae.verify.operations.property import (
    UPSTREAM,
    Finding,
    Findings,
    Property,
    compared,
    drawn_upstream,
    property_of,
)

WIDE_BOUND = 0.99
_STATED: dict[str, list[tuple]] = {}
"""For each operation, the name, statement, findings and sizes of its properties."""


def single_properties(operation: Operation) -> Iterator[Property]:
    """The properties that only this operation has."""
    for names, name, statement, values in COMPARED:
        if operation.name in names.split():
            classes = UPSTREAM | {"values": values}
            yield property_of(operation, name, statement, compared, classes)
    for name, statement, findings, sizes in _STATED.get(operation.name, ()):
        yield property_of(operation, name, statement, findings, UPSTREAM | sizes)


def states(names: str, name: str, statement: str, **sizes: tuple) -> Callable:
    """Make findings a property of operations, tried at `sizes` in place of the operation's own.

    They are drawn with an implementation, a case and the arguments by name.
    """

    def register(drawn: Callable[..., Findings]) -> None:
        def findings(operation: Operation, implementation: Callable, case: Case) -> Findings:
            return drawn(implementation, case, **operation.arguments(case))

        for operation in names.split():
            _STATED.setdefault(operation, []).append((name, statement, findings, sizes))

    return register


SATURATED = "at ±1000 it is saturated: its limits, a gradient of 0, no overflow into nan"
BEYOND = "beyond the bound the value is arctanh(±bound) and the gradient exactly 0"
TIES = "a tie goes to the earlier frame, value and whole gradient"
LOSER = "the smaller frame's gradient is exactly 0"
AT_ZERO = "at y = 0 the gradient is exactly 0"
FEW = (1, 2, 3, 4, 5)
LOSSES = "mean_squared_error mean_absolute sliced_wasserstein"
COMPARED = (
    ("max_pool", "ties", TIES, TIED),
    ("max_pool", "loser", LOSER, WITHOUT_TIES["values"]),
    ("tanh sigmoid", "large inputs", SATURATED, ("huge",)),
    ("arctanh", "beyond the bound", BEYOND, ("bound", "large", "huge")),
    ("mean_absolute", "zero at zero", AT_ZERO, ("zeros", "signed zeros")),
)
"""Operations, name, statement, and the classes of values."""


@states(
    "conv1d",
    "shift in time",
    "away from the edges, a frame's delay of x delays y by a frame",
    frames=(8, 9, 10),
    taps=(1, 3, 5),
)
def _shift(conv1d, case, x, w, b):
    beyond = len(w) // 2
    later = conv1d(np.roll(x, 1, axis=1), w, b)[0][:, beyond + 1 : case["frames"] - beyond]
    middle = slice(beyond, case["frames"] - beyond - 1)
    yield Finding("one frame later, the value", later, conv1d(x, w, b)[0][:, middle])


@states("transpose_filters", "own inverse", "transposing twice changes nothing")
def _own_inverse(transpose_filters, case, w):
    yield Finding("transposed twice, the bank", transpose_filters(transpose_filters(w)[0])[0], w)


@states("unpool_random", "empty slot", "the other frame of the pair is exactly 0")
def _empty_slot(unpool_random, case, y, first):
    x, _ = unpool_random(y, first)
    yield Finding("the other frame", np.where(first, x[:, 1::2], x[:, 0::2]), np.zeros_like(y), 0)


@states("unpool_even unpool_random", "pair sums", "both frames of a pair sum to y")
def _pair_sums(unpool, case, y, **mask):
    x, _ = unpool(y, *mask.values())
    yield Finding("the sum of a pair", x[:, 0::2] + x[:, 1::2], y)


@states(
    "arctanh",
    "inverse of tanh",
    "arctanh ∘ tanh is the identity inside the bound, its derivative too",
)
def _inverse_of_tanh(arctanh, case, y, bound):
    x = spread(case.rng(), y.shape, np.arctanh(WIDE_BOUND) * 0.999)
    y, tanh_pullback = ops.tanh(x)
    back, pullback = arctanh(y, WIDE_BOUND)
    yield Finding("arctanh(tanh(x))", back, x)
    dx = drawn_upstream(case, x)
    yield Finding("through arctanh and tanh, the gradient", tanh_pullback(pullback(dx)), dx)


@states("gru", "causality", "no frame depends on a later one", frames=(2, 3, 4, 9))
def _causality(gru, case, x, **others):
    earlier, _ = gru(x[:, :-1], *others.values())
    whole, _ = gru(x, *others.values())
    yield Finding("of the earlier frames alone the value", earlier, whole[:, :-1])


@states("gru", "kept state", "a sequence in two pieces is the whole one", frames=(2, 3, 4, 9))
def _kept_state(gru, case, x, h0, **weights):
    head, _ = gru(x[:, :1], h0, *weights.values())
    tail, _ = gru(x[:, 1:], head[:, -1], *weights.values())
    whole, _ = gru(x, h0, *weights.values())
    yield Finding("in two pieces the value", np.concatenate([head, tail], axis=1), whole)


@states(
    "mean_squared_error",
    "zero at the target",
    "where x_hat equals x, loss and gradient are exactly 0",
)
def _zero_at_the_target(mean_squared_error, case, x_hat, x):
    loss, pullback = mean_squared_error(x.copy(), x)
    yield Finding("at the target the loss", loss, 0.0, 0)
    dloss = drawn_upstream(case, loss)
    yield Finding("at the target the gradient", pullback(dloss), np.zeros_like(x), 0)


@states("sliced_wasserstein", "equal sets", "between equal sets distance and gradient are 0")
def _equal_sets(sliced_wasserstein, case, z, prior, directions):
    loss, pullback = sliced_wasserstein(case.rng().permutation(z), z, directions)
    yield Finding("between equal sets the distance", loss, 0.0)
    yield Finding("between equal sets the gradient", pullback(1.0), np.zeros_like(z))


@states("sliced_wasserstein", "order", "the order of the points does not matter")
def _order(sliced_wasserstein, case, z, prior, directions):
    order = case.rng().permutation(len(z))
    loss, pullback = sliced_wasserstein(z, prior, directions)
    again, pullback_again = sliced_wasserstein(z[order], prior[order[::-1]], directions)
    yield Finding("in another order the distance", again, loss)
    if len(np.unique(z + 0.0, axis=0)) == len(z):  # equal points share a gradient in any way
        yield Finding("in another order the gradient", pullback_again(1.0), pullback(1.0)[order])


@states(
    "sliced_wasserstein",
    "optimal assignment",
    "in one dimension it is the cheapest assignment on squared costs, mean over points",
    points=FEW,
    dimensions=(1,),
)
def _assignment(sliced_wasserstein, case, z, prior, directions):
    cheapest = min(np.mean((np.array(order) - prior) ** 2) for order in permutations(z))
    yield Finding("the distance", sliced_wasserstein(z, prior, np.ones((1, 1)))[0], cheapest)


@states(
    LOSSES, "upstream default", "called without the upstream number, the pullback takes it to be 1"
)
def _one_by_default(loss, case, **arguments):
    for dtype in (np.float64, np.float32):
        _, pullback = loss(*(array.astype(dtype) for array in arguments.values()))
        by_default = pullback()
        of_one = pullback(1.0)
        yield Finding("by default the gradient", by_default, of_one, 0)
        yield Finding(
            "by default the gradient's bytes a number", by_default.itemsize, of_one.itemsize, 0
        )
