"""Properties of single operations: shifts, ties, empty slots, bounds, order, time.

Where a property says what the definition returns for one class of values, it is a row of
`COMPARED`; the others are functions below.
"""

from collections.abc import Callable, Iterator
from itertools import permutations

import numpy as np

from numpy_cae import ops
from numpy_cae.verify.operations.case import ORDINARY, Case, spread
from numpy_cae.verify.operations.operation import TIED, WITHOUT_TIES, Operation
from numpy_cae.verify.operations.property import (
    UPSTREAM,
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
    for name, statement, findings, sizes in _STATED.get(operation.name, ()):
        yield property_of(operation, name, statement, findings, UPSTREAM | sizes)


def states(names: str, name: str, statement: str, **sizes: tuple) -> Callable:
    """Make findings a property of operations, tried at `sizes` in place of the operation's own.

    They are drawn with an implementation, a case and the arguments by name.
    """

    def register(drawn: Callable[..., Findings]) -> None:
        def findings(operation: Operation, implementation: Callable, case: Case) -> Findings:
            yield from drawn(implementation, case, **operation.arguments(case))

        _state(names, name, statement, findings, sizes)

    return register


def _state(names: str, name: str, statement: str, findings: Callable, sizes: dict) -> None:
    for operation in names.split():
        _STATED.setdefault(operation, []).append((name, statement, findings, sizes))


SATURATED = "at ±1000 it is saturated: its limits, a gradient of 0, no overflow into nan"
BEYOND = "beyond the bound the value is arctanh(±bound) and the gradient exactly 0"
TIES = "a tie goes to the earlier frame, value and whole gradient"
LOSER = "the smaller frame's gradient is exactly 0"
AT_ZERO = "at y = 0 the gradient is exactly 0"
SHIFT = "away from the edges, a frame's delay of x delays y by a frame"
INVERSE = "arctanh ∘ tanh is the identity inside the bound, its derivative too"
AT_TARGET = "where x_hat equals x, loss and gradient are exactly 0"
CHEAPEST = "in one dimension it is the cheapest assignment on squared costs, mean over points"
BY_DEFAULT = "called without the upstream number, the pullback takes it to be 1"
OTHER_SHARE = "where the {}'s share of dL/dw is 0, the {}'s is right".format
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
for _names, _name, _statement, _values in COMPARED:
    _state(_names, _name, _statement, compared, {"values": _values})


@states("conv1d", "shift in time", SHIFT, frames=(8, 9, 10), taps=(1, 3, 5))
def _shift(conv1d, case, x, w, b):
    beyond = len(w) // 2
    later = conv1d(np.roll(x, 1, axis=1), w, b)[0][:, beyond + 1 : case["frames"] - beyond]
    middle = slice(beyond, case["frames"] - beyond - 1)
    yield "one frame later, the value", later, conv1d(x, w, b)[0][:, middle]


@states("transpose_filters", "own inverse", "transposing twice changes nothing")
def _own_inverse(transpose_filters, case, w):
    yield "transposed twice, the bank", transpose_filters(transpose_filters(w)[0])[0], w


@states("unpool_random", "empty slot", "the other frame of the pair is exactly 0")
def _empty_slot(unpool_random, case, y, first):
    x, _ = unpool_random(y, first)
    yield "the other frame", np.where(first, x[:, 1::2], x[:, 0::2]), np.zeros_like(y), 0


@states("unpool_even unpool_random", "pair sums", "both frames of a pair sum to y")
def _pair_sums(unpool, case, y, **mask):
    x, _ = unpool(y, *mask.values())
    yield "the sum of a pair", x[:, 0::2] + x[:, 1::2], y


@states("arctanh", "inverse of tanh", INVERSE)
def _inverse_of_tanh(arctanh, case, y, bound):
    x = spread(case.rng(), y.shape, np.arctanh(WIDE_BOUND) * 0.999)
    y, tanh_pullback = ops.tanh(x)
    back, pullback = arctanh(y, WIDE_BOUND)
    yield "arctanh(tanh(x))", back, x
    dx = drawn_upstream(case, x)
    through = tanh_pullback(np.reshape(pullback(dx), x.shape))
    yield "through arctanh and tanh, the gradient", through, dx


@states("linear", "rows alone", "each row is mapped as if it were alone")
def _rows_alone(linear, case, x, w, b):
    alone = np.stack([linear(row, w, b)[0] for row in x.reshape(-1, len(w))])
    yield "of all rows at once the value", linear(x, w, b)[0], alone.reshape(*x.shape[:-1], -1)


@states("gru", "causality", "no frame depends on a later one", frames=(2, 3, 4, 9))
def _causality(gru, case, x, **others):
    earlier, _ = gru(x[:, :-1], *others.values())
    whole, _ = gru(x, *others.values())
    yield "of the earlier frames alone the value", earlier, whole[:, :-1]


@states("gru", "kept state", "a sequence in two pieces is the whole one", frames=(2, 3, 4, 9))
def _kept_state(gru, case, x, h0, **weights):
    head, _ = gru(x[:, :1], h0, *weights.values())
    tail, _ = gru(x[:, 1:], head[:, -1], *weights.values())
    whole, _ = gru(x, h0, *weights.values())
    yield "in two pieces the value", np.concatenate([head, tail], axis=1), whole


@states("mean_squared_error", "zero at the target", AT_TARGET)
def _zero_at_the_target(mean_squared_error, case, x_hat, x):
    loss, pullback = mean_squared_error(x.copy(), x)
    yield "at the target the loss", loss, 0.0, 0
    dx_hat = np.reshape(pullback(drawn_upstream(case, loss)), x.shape)
    yield "at the target the gradient", dx_hat, np.zeros_like(x), 0


@states("sliced_wasserstein", "equal sets", "between equal sets distance and gradient are 0")
def _equal_sets(sliced_wasserstein, case, z, prior, directions):
    loss, pullback = sliced_wasserstein(case.rng().permutation(z), z, directions)
    yield "between equal sets the distance", loss, 0.0
    yield "between equal sets the gradient", np.reshape(pullback(1.0), z.shape), np.zeros_like(z)


@states("sliced_wasserstein", "order", "the order of the points does not matter")
def _order(sliced_wasserstein, case, z, prior, directions):
    order = case.rng().permutation(len(z))
    loss, pullback = sliced_wasserstein(z, prior, directions)
    again, pullback_again = sliced_wasserstein(z[order], prior[order[::-1]], directions)
    yield "in another order the distance", again, loss
    if len(np.unique(z + 0.0, axis=0)) == len(z):  # equal points share a gradient in any way
        of_order = np.reshape(pullback(1.0), z.shape)[order]
        gradient = np.reshape(pullback_again(1.0), z.shape)
        yield "in another order the gradient", gradient, of_order


@states("sliced_wasserstein", "optimal assignment", CHEAPEST, points=FEW, dimensions=(1,))
def _assignment(sliced_wasserstein, case, z, prior, directions):
    cheapest = min(np.mean((np.array(order) - prior) ** 2) for order in permutations(z))
    yield "the distance", sliced_wasserstein(z, prior, np.ones((1, 1)))[0], cheapest


@states(LOSSES, "upstream default", BY_DEFAULT)
def _one_by_default(loss, case, **arguments):
    for dtype in (np.float64, np.float32):
        _, pullback = loss(*(array.astype(dtype) for array in arguments.values()))
        by_default, of_one = pullback(), pullback(1.0)
        yield "by default the gradient", by_default, of_one, 0
        yield "by default the gradient's bytes a number", by_default.itemsize, of_one.itemsize, 0


SMALL = {"batch": (2, 3), "frames": (4, 5, 6), "taps": (1, 3), "filters": (1, 2)}
SMALL["channels"] = (1, 2, 3)
SMALL["values"] = (ORDINARY, "random")


@states("tied_layer", "encoder's share", OTHER_SHARE("decoder", "encoder"), **SMALL)
def _encoder_alone(tied_layer, case, x, w, b):
    """The upstream gradient is one that cancels in the decoder's share."""
    y = np.tanh(ops.conv1d(x, w, b)[0]) - b
    units = (ops.transpose_filters(unit.reshape(w.shape))[0] for unit in np.eye(w.size))
    moves = np.reshape([ops.conv1d(y, unit, 0 * x[0, 0])[0] for unit in units], (w.size, -1))
    dx_hat = spread(case.rng(), x.shape)
    dx_hat -= (np.linalg.pinv(moves) @ (moves @ dx_hat.ravel())).reshape(x.shape)
    dy = ops.conv1d(dx_hat, w, np.zeros_like(b))[0] * (1 - (y + b) ** 2)
    _, expected, _ = ops.conv1d(x, w, b)[1](dy)
    dw = tied_layer(x, w, b)[1](dx_hat)[1]
    yield "the encoder's share of the gradient for w", dw, expected


@states("tied_layer", "decoder's share", OTHER_SHARE("encoder", "decoder"), **SMALL)
def _decoder_alone(tied_layer, case, x, w, b):
    """The units are saturated, and pass no gradient to the encoder."""
    b = 60 * np.sign(b)
    dx_hat = spread(case.rng(), x.shape)
    w_tilde, of_transpose = ops.transpose_filters(w)
    _, of_decoding = ops.conv1d(np.sign(b) - b + np.zeros((*x.shape[:2], 1)), w_tilde, 0 * x[0, 0])
    dw = tied_layer(x, w, b)[1](dx_hat)[1]
    expected = of_transpose(of_decoding(dx_hat)[1])
    yield "the decoder's share of the gradient for w", dw, expected
