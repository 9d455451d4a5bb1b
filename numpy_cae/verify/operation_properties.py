"""Properties of single operations: shifts, ties, empty slots, bounds, order, time.

Where a property says what the definition returns for one class of values, it is a row of
`COMPARED`; the others are functions below.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from numpy_cae import ops
from numpy_cae.verify.case import ORDINARY, Case, Sizes, spread
from numpy_cae.verify.operation import Operation
from numpy_cae.verify.property import (
    UPSTREAM,
    Property,
    copied,
    copies,
    differentiated,
    drawn_upstream,
    require_equal,
)

WIDE_BOUND = 0.99

Check = Callable[[Operation, Callable, Case], None]
_STATED: dict[str, list[Callable[[Operation], Property]]] = {}
"""For each operation, what makes its properties."""


def operation_properties(operation: Operation) -> Iterator[Property]:
    """The properties that only this operation has."""
    for stated in _STATED.get(operation.name, ()):
        yield stated(operation)


def states(name: str, statement: str, *operations: str, **sizes: tuple) -> Callable[[Check], Check]:
    """Make a check a property of operations, tried at `sizes` in place of the operation's own."""

    def register(check: Check) -> Check:
        def stated(operation: Operation) -> Property:
            return Property(
                operation.name,
                name,
                statement,
                partial(check, operation),
                operation.arguments,
                {**operation.sizes, **UPSTREAM, **sizes},
                of=operation,
            )

        for operation in operations:
            _STATED.setdefault(operation, []).append(stated)
        return check

    return register


def _only(pulled) -> np.ndarray:
    return pulled[0] if isinstance(pulled, tuple | list) else pulled


def _compared(compare_value: bool, compare_gradient: bool, zeros_only: bool) -> Check:
    """Compare with the definition; with `zeros_only`, where that returns 0 require exactly 0."""

    def check(operation: Operation, implementation: Callable, case: Case) -> None:
        arguments = operation.arguments(case)
        value, pullback = implementation(*copies(arguments))
        expected_value, reference = operation.reference(*copies(arguments))
        dy = drawn_upstream(case, expected_value)
        pairs = []
        if compare_value:
            pairs.append(("the value", value, expected_value))
        if compare_gradient:
            found = differentiated(operation, pullback(copied(dy)))
            expected = differentiated(operation, reference(copied(dy)))
            pairs += [(f"the gradient for {n}", found[n], expected[n]) for n in expected]
        for what, found, expected in pairs:
            if zeros_only and np.shape(found) == np.shape(expected):
                empty = np.asarray(expected) == 0
                require_equal(
                    f"where it is to be 0, {what}", np.where(empty, found, 0), 0 * expected, 0
                )
            else:
                require_equal(what, *(operation.alike(arguments, a) for a in (found, expected)))

    return check


VALUE, GRADIENT, BOTH = (True, False, False), (False, True, False), (True, True, False)
ZEROS_OF_VALUE, ZEROS_OF_GRADIENT = (True, False, True), (False, True, True)
LOSSES = ("mean_squared_error", "mean_absolute", "sliced_wasserstein")
TIED = ("ties", "zeros", "signed zeros")

COMPARED: tuple[tuple[str, str, tuple[str, ...], tuple, Sizes], ...] = (
    (
        "ties",
        "a tie goes to the earlier frame, value and whole gradient",
        ("max_pool",),
        BOTH,
        {"values": TIED},
    ),
    ("loser", "the smaller frame's gradient is exactly 0", ("max_pool",), ZEROS_OF_GRADIENT, {}),
    (
        "empty slot",
        "the other frame of the pair is exactly 0",
        ("unpool_random",),
        ZEROS_OF_VALUE,
        {},
    ),
    (
        "large inputs",
        "at ±1000 it is saturated: its limits, a gradient of 0, no overflow into nan",
        ("tanh", "sigmoid"),
        BOTH,
        {"values": ("huge",)},
    ),
    (
        "beyond the bound",
        "beyond the bound the value is arctanh(±bound) and the gradient exactly 0",
        ("arctanh",),
        BOTH,
        {"values": ("bound", "large", "huge")},
    ),
    (
        "repeated gru_step",
        "value and gradients are those of gru_step, repeated",
        ("gru",),
        BOTH,
        {},
    ),
    (
        "zero at zero",
        "at y = 0 the gradient is exactly 0",
        ("mean_absolute",),
        ZEROS_OF_GRADIENT,
        {"values": ("zeros", "signed zeros")},
    ),
)
for _name, _statement, _operations, _parts, _sizes in COMPARED:
    states(_name, _statement, *_operations, **_sizes)(_compared(*_parts))


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


@states("pair sums", "both frames of a pair sum to y", "unpool_even", "unpool_random")
def _pair_sums(operation: Operation, unpool: Callable, case: Case) -> None:
    arguments = operation.arguments(case)
    (x, _), (expected, _) = unpool(*arguments.values()), operation.reference(*arguments.values())
    of_pairs = expected[:, 0::2] + expected[:, 1::2]
    require_equal("the sum of a pair", x[:, 0::2] + x[:, 1::2], of_pairs)


@states(
    "inverse of tanh",
    "arctanh ∘ tanh is the identity inside the bound, its derivative too",
    "arctanh",
    values=(ORDINARY,),
)
def _inverse_of_tanh(operation: Operation, arctanh: Callable, case: Case) -> None:
    x = spread(case.rng(), operation.arguments(case)["y"].shape, np.arctanh(WIDE_BOUND) * 0.999)
    y, tanh_pullback = ops.tanh(x)
    back, pullback = arctanh(y, WIDE_BOUND)
    require_equal("arctanh(tanh(x))", back, x)
    dx = drawn_upstream(case, x)
    require_equal("through arctanh and tanh, the gradient", tanh_pullback(_only(pullback(dx))), dx)


@states("rows alone", "each row is mapped as if it were alone", "linear")
def _rows_alone(operation: Operation, linear: Callable, case: Case) -> None:
    x, w, b = operation.arguments(case).values()
    rows = x.reshape(-1, x.shape[-1])
    alone = np.stack([linear(row, w, b)[0] for row in rows]).reshape(*x.shape[:-1], -1)
    require_equal("of all rows at once the value", linear(x, w, b)[0], alone)


@states("causality", "no frame depends on a later one", "gru", frames=(2, 3, 4, 9))
def _causality(operation: Operation, gru: Callable, case: Case) -> None:
    x, *others = operation.arguments(case).values()
    earlier, _ = gru(x[:, :-1], *others)
    require_equal("of the earlier frames alone the value", earlier, gru(x, *others)[0][:, :-1])


@states("kept state", "a sequence in two pieces is the whole one", "gru", frames=(2, 3, 4, 9))
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
    dx_hat = _only(pullback(drawn_upstream(case, loss)))
    require_equal("at the target the loss", loss, 0.0, 0)
    require_equal("at the target the gradient", dx_hat, np.zeros_like(x), 0)


@states("equal sets", "between equal sets distance and gradient are 0", "sliced_wasserstein")
def _equal_sets(operation: Operation, sliced_wasserstein: Callable, case: Case) -> None:
    z, _, directions = operation.arguments(case).values()
    loss, pullback = sliced_wasserstein(case.rng().permutation(z), z, directions)
    require_equal("between equal sets the distance", loss, 0.0)
    require_equal("between equal sets the gradient", _only(pullback(1.0)), np.zeros_like(z))


@states("order", "the order of the points does not matter", "sliced_wasserstein")
def _order(operation: Operation, sliced_wasserstein: Callable, case: Case) -> None:
    arguments = operation.arguments(case)
    z, prior, directions = arguments.values()
    order = case.rng().permutation(len(z))
    loss, pullback = sliced_wasserstein(z, prior, directions)
    again, pullback_again = sliced_wasserstein(z[order], prior[order[::-1]], directions)
    require_equal("in another order the distance", again, loss)
    dz = np.empty_like(z)
    dz[order] = _only(pullback_again(1.0))
    found, expected = (operation.alike(arguments, g) for g in (dz, _only(pullback(1.0))))
    require_equal("in another order the gradient", found, expected)


@states(
    "optimal assignment",
    "in one dimension it is the cheapest assignment on squared costs, mean over points",
    "sliced_wasserstein",
    dimensions=(1,),
)
def _assignment(operation: Operation, sliced_wasserstein: Callable, case: Case) -> None:
    z, prior, _ = operation.arguments(case).values()
    axis = np.ones((1, 1))
    expected, _ = operation.reference(z, prior, axis)
    require_equal("the distance", sliced_wasserstein(z, prior, axis)[0], expected)


@states(
    "upstream default",
    "called without the upstream number, the pullback takes it to be 1",
    *LOSSES,
)
def _one_by_default(operation: Operation, loss: Callable, case: Case) -> None:
    _, pullback = loss(*operation.arguments(case).values())
    require_equal("by default the gradient", _only(pullback()), _only(pullback(1.0)), 0)


def _share_alone(decoder: bool) -> Check:
    """Test one share of dL/dW where the other is 0, so that neither can make up for the other."""

    def check(operation: Operation, tied_layer: Callable, case: Case) -> None:
        x, w, b = operation.arguments(case).values()
        dx_hat = spread(case.rng(), x.shape)
        if decoder:  # saturated units pass no gradient to the encoder
            b = 60 * np.sign(b)
        else:  # an upstream gradient that cancels in the decoder's share
            y = np.tanh(ops.conv1d(x, w, b)[0]) - b
            units = np.eye(w.size).reshape(-1, *w.shape)
            moves = [
                ops.conv1d(y, ops.transpose_filters(unit)[0], 0 * x[0, 0])[0] for unit in units
            ]
            moves = np.reshape(moves, (w.size, -1))
            dx_hat -= (np.linalg.pinv(moves) @ (moves @ dx_hat.ravel())).reshape(x.shape)
        (_, dw, _), (_, expected, _) = (
            f(x.copy(), w.copy(), b.copy())[1](dx_hat.copy())
            for f in (tied_layer, operation.reference)
        )
        who = "decoder's" if decoder else "encoder's"
        require_equal(f"the {who} share of the gradient for w", dw, expected)

    return check


_SMALL = {"batch": (2, 3), "frames": (4, 5, 6), "taps": (1, 3), "upstream": (ORDINARY,)}
_UNSATURATED = {"values": (ORDINARY, "random"), "filters": (1, 2)}
states(
    "encoder's share",
    "where the decoder's share of dL/dw is 0, the encoder's is right",
    "tied_layer",
    **_SMALL,
    **_UNSATURATED,
)(_share_alone(decoder=False))
states(
    "decoder's share",
    "where the encoder's share of dL/dw is 0, the decoder's is right",
    "tied_layer",
    **_SMALL,
    values=(ORDINARY, "random"),
)(_share_alone(decoder=True))
