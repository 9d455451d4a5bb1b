"""Properties of single operations: shifts, ties, empty slots, bounds, order, time.

Where a property says what the definition returns for one class of values, it is a row of
`COMPARED`; the others are functions below.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.optimize import linear_sum_assignment

from numpy_cae import ops
from numpy_cae.verify.case import ORDINARY, Case, spread
from numpy_cae.verify.operation import Operation
from numpy_cae.verify.property import (
    UPSTREAM,
    Findings,
    Property,
    copies,
    drawn_upstream,
    property_of,
    results,
)

WIDE_BOUND = 0.99

_STATED: dict[str, list[tuple]] = {}
"""For each operation, the name, statement, findings and sizes of its properties."""


def operation_properties(operation: Operation) -> Iterator[Property]:
    """The properties that only this operation has."""
    for name, statement, findings, sizes in _STATED.get(operation.name, ()):
        yield property_of(operation, name, statement, findings, UPSTREAM | sizes)


def states(name: str, statement: str, *operations: str, **sizes: tuple) -> Callable:
    """Make findings a property of operations, tried at `sizes` in place of the operation's own.

    They are drawn with an implementation, a case and the arguments by name.
    """

    def register(drawn: Callable[..., Findings]) -> Callable[..., Findings]:
        def findings(operation: Operation, implementation: Callable, case: Case) -> Findings:
            yield from drawn(implementation, case, **operation.arguments(case))

        stated = drawn if drawn.__name__ == "compared" else findings
        for operation in operations:
            _STATED.setdefault(operation, []).append((name, statement, stated, sizes))
        return drawn

    return register


def _compared(what: str, exactly_zero: bool = False) -> Callable[..., Findings]:
    """Compare results with the definition's, or only where these are 0, and then exactly."""

    def compared(operation: Operation, implementation: Callable, case: Case) -> Findings:
        arguments = operation.arguments(case)
        dy = drawn_upstream(case, operation.reference(*copies(arguments))[0])
        functions = (implementation, operation.reference)
        found, expected = (results(operation, f, copies(arguments), dy) for f in functions)
        for name, right in expected.items():
            if what in name and exactly_zero:
                empty = np.asarray(right) == 0
                yield f"where it is to be 0, {name}", np.where(empty, found[name], 0), 0 * right, 0
            elif what in name:
                yield name, *(operation.alike(arguments, a) for a in (found[name], right))

    return compared


COMPARED = (
    ("ties", "a tie goes to the earlier frame, value and whole gradient", "max_pool", ("the",)),
    ("loser", "the smaller frame's gradient is exactly 0", "max_pool", ("gradient", True)),
    ("empty slot", "the other frame of the pair is exactly 0", "unpool_random", ("value", True)),
    (
        "large inputs",
        "at ±1000 it is saturated: its limits, a gradient of 0, no overflow into nan",
        "tanh sigmoid",
        ("the",),
    ),
    (
        "beyond the bound",
        "beyond the bound the value is arctanh(±bound) and the gradient exactly 0",
        "arctanh",
        ("the",),
    ),
    ("repeated gru_step", "value and gradients are those of gru_step, repeated", "gru", ("the",)),
    ("zero at zero", "at y = 0 the gradient is exactly 0", "mean_absolute", ("gradient", True)),
)
VALUES_OF = {
    "ties": ("ties", "zeros", "signed zeros"),
    "large inputs": ("huge",),
    "beyond the bound": ("bound", "large", "huge"),
    "zero at zero": ("zeros", "signed zeros"),
}
for _name, _statement, _operations, _results in COMPARED:
    _classes = {"values": VALUES_OF[_name]} if _name in VALUES_OF else {}
    states(_name, _statement, *_operations.split(), **_classes)(_compared(*_results))


@states(
    "shift in time",
    "away from the edges, a frame's delay of x delays y by a frame",
    "conv1d",
    frames=(8, 9, 10),
    taps=(1, 3, 5),
)
def _shift(conv1d, case, x, w, b):
    beyond = len(w) // 2
    later = conv1d(np.roll(x, 1, axis=1), w, b)[0][:, beyond + 1 : case["frames"] - beyond]
    middle = slice(beyond, case["frames"] - beyond - 1)
    yield "one frame later, the value", later, conv1d(x, w, b)[0][:, middle]


@states("own inverse", "transposing twice changes nothing", "transpose_filters")
def _own_inverse(transpose_filters, case, w):
    yield "transposed twice, the bank", transpose_filters(transpose_filters(w)[0])[0], w


@states("pair sums", "both frames of a pair sum to y", "unpool_even", "unpool_random")
def _pair_sums(unpool, case, y, **mask):
    x, _ = unpool(y, *mask.values())
    yield "the sum of a pair", x[:, 0::2] + x[:, 1::2], y


@states(
    "inverse of tanh",
    "arctanh ∘ tanh is the identity inside the bound, its derivative too",
    "arctanh",
)
def _inverse_of_tanh(arctanh, case, y, bound):
    x = spread(case.rng(), y.shape, np.arctanh(WIDE_BOUND) * 0.999)
    y, tanh_pullback = ops.tanh(x)
    back, pullback = arctanh(y, WIDE_BOUND)
    yield "arctanh(tanh(x))", back, x
    dx = drawn_upstream(case, x)
    through = tanh_pullback(np.reshape(pullback(dx), x.shape))
    yield "through arctanh and tanh, the gradient", through, dx


@states("rows alone", "each row is mapped as if it were alone", "linear")
def _rows_alone(linear, case, x, w, b):
    alone = np.stack([linear(row, w, b)[0] for row in x.reshape(-1, len(w))])
    yield "of all rows at once the value", linear(x, w, b)[0], alone.reshape(*x.shape[:-1], -1)


@states("causality", "no frame depends on a later one", "gru", frames=(2, 3, 4, 9))
def _causality(gru, case, x, **others):
    earlier, _ = gru(x[:, :-1], *others.values())
    whole, _ = gru(x, *others.values())
    yield "of the earlier frames alone the value", earlier, whole[:, :-1]


@states("kept state", "a sequence in two pieces is the whole one", "gru", frames=(2, 3, 4, 9))
def _kept_state(gru, case, x, h0, **weights):
    head, _ = gru(x[:, :1], h0, *weights.values())
    tail, _ = gru(x[:, 1:], head[:, -1], *weights.values())
    whole, _ = gru(x, h0, *weights.values())
    yield "in two pieces the value", np.concatenate([head, tail], axis=1), whole


@states(
    "zero at the target",
    "where x_hat equals x, loss and gradient are exactly 0",
    "mean_squared_error",
)
def _zero_at_the_target(mean_squared_error, case, x_hat, x):
    loss, pullback = mean_squared_error(x.copy(), x)
    yield "at the target the loss", loss, 0.0, 0
    dx_hat = np.reshape(pullback(drawn_upstream(case, loss)), x.shape)
    yield "at the target the gradient", dx_hat, np.zeros_like(x), 0


@states("equal sets", "between equal sets distance and gradient are 0", "sliced_wasserstein")
def _equal_sets(sliced_wasserstein, case, z, prior, directions):
    loss, pullback = sliced_wasserstein(case.rng().permutation(z), z, directions)
    yield "between equal sets the distance", loss, 0.0
    yield "between equal sets the gradient", np.reshape(pullback(1.0), z.shape), np.zeros_like(z)


@states("order", "the order of the points does not matter", "sliced_wasserstein")
def _order(sliced_wasserstein, case, z, prior, directions):
    order = case.rng().permutation(len(z))
    loss, pullback = sliced_wasserstein(z, prior, directions)
    again, pullback_again = sliced_wasserstein(z[order], prior[order[::-1]], directions)
    yield "in another order the distance", again, loss
    if len(np.unique(z + 0.0, axis=0)) == len(z):  # equal points share a gradient in any way
        of_order = np.reshape(pullback(1.0), z.shape)[order]
        gradient = np.reshape(pullback_again(1.0), z.shape)
        yield "in another order the gradient", gradient, of_order


@states(
    "optimal assignment",
    "in one dimension it is the cheapest assignment on squared costs, mean over points",
    "sliced_wasserstein",
    dimensions=(1,),
)
def _assignment(sliced_wasserstein, case, z, prior, directions):
    cost = (z - prior.T) ** 2
    cheapest = cost[linear_sum_assignment(cost)].mean()
    yield "the distance", sliced_wasserstein(z, prior, np.ones((1, 1)))[0], cheapest


@states(
    "upstream default",
    "called without the upstream number, the pullback takes it to be 1",
    "mean_squared_error",
    "mean_absolute",
    "sliced_wasserstein",
)
def _one_by_default(loss, case, **arguments):
    _, pullback = loss(*arguments.values())
    yield "by default the gradient", pullback(), pullback(1.0), 0


_SMALL = {"batch": (2, 3), "frames": (4, 5, 6), "taps": (1, 3), "filters": (1, 2)}


@states(
    "encoder's share",
    "where the decoder's share of dL/dw is 0, the encoder's is right",
    "tied_layer",
    values=(ORDINARY, "random"),
    **_SMALL,
)
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


@states(
    "decoder's share",
    "where the encoder's share of dL/dw is 0, the decoder's is right",
    "tied_layer",
    values=(ORDINARY, "random"),
    **_SMALL,
)
def _decoder_alone(tied_layer, case, x, w, b):
    """The units are saturated, and pass no gradient to the encoder."""
    b = 60 * np.sign(b)
    dx_hat = spread(case.rng(), x.shape)
    w_tilde, of_transpose = ops.transpose_filters(w)
    _, of_decoding = ops.conv1d(np.sign(b) - b + np.zeros((*x.shape[:2], 1)), w_tilde, 0 * x[0, 0])
    dw = tied_layer(x, w, b)[1](dx_hat)[1]
    expected = of_transpose(of_decoding(dx_hat)[1])
    yield "the decoder's share of the gradient for w", dw, expected
