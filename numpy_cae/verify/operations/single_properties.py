"""Properties of single operations: shifts, ties, empty slots, bounds, order, time.

They are rows of the table `operations.toml`. Where a property says what the definition returns for
one class of values, it has no findings of its own.
"""

from collections.abc import Callable, Iterator
from functools import partial
from itertools import permutations

import numpy as np

from numpy_cae import ops
from numpy_cae.verify.operations import property as comparing
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.operation import TABLE, Operation, sizes_of
from numpy_cae.verify.operations.property import Finding, Findings, Property

WIDE_BOUND = 0.99


def single_properties(operation: Operation) -> Iterator[Property]:
    """The properties that only this operation has."""
    for row in TABLE["properties"]:
        if operation.name in row["operations"].split():
            drawn = FINDINGS.get(row.get("findings"))
            findings = partial(_with_arguments, drawn) if drawn else comparing.compared
            classes = comparing.UPSTREAM | sizes_of(row.get("sizes", {}))
            stated = row["name"], row["statement"]
            yield comparing.property_of(operation, *stated, findings, classes)


def _with_arguments(
    drawn: Callable[..., Findings], operation: Operation, implementation: Callable, case: Case
) -> Findings:
    """The findings for an implementation, a case and its arguments by name."""
    return drawn(implementation, case, **operation.arguments(case))


def _shift(conv1d, case, x, w, b):
    beyond = len(w) // 2
    later = conv1d(np.roll(x, 1, axis=1), w, b)[0][:, beyond + 1 : case["frames"] - beyond]
    middle = slice(beyond, case["frames"] - beyond - 1)
    yield Finding("one frame later, the value", later, conv1d(x, w, b)[0][:, middle])


def _own_inverse(transpose_filters, case, w):
    yield Finding("transposed twice, the bank", transpose_filters(transpose_filters(w)[0])[0], w)


def _empty_slot(unpool_random, case, y, first):
    x, _ = unpool_random(y, first)
    yield Finding("the other frame", np.where(first, x[:, 1::2], x[:, 0::2]), np.zeros_like(y), 0)


def _pair_sums(unpool, case, y, **mask):
    x, _ = unpool(y, *mask.values())
    yield Finding("the sum of a pair", x[:, 0::2] + x[:, 1::2], y)


def _inverse_of_tanh(arctanh, case, y, bound):
    x = spread(case.rng(), y.shape, np.arctanh(WIDE_BOUND) * 0.999)
    y, tanh_pullback = ops.tanh(x)
    back, pullback = arctanh(y, WIDE_BOUND)
    yield Finding("arctanh(tanh(x))", back, x)
    dx = comparing.drawn_upstream(case, x)
    yield Finding("through arctanh and tanh, the gradient", tanh_pullback(pullback(dx)), dx)


def _causality(gru, case, x, **others):
    earlier, _ = gru(x[:, :-1], *others.values())
    whole, _ = gru(x, *others.values())
    yield Finding("of the earlier frames alone the value", earlier, whole[:, :-1])


def _kept_state(gru, case, x, h0, **weights):
    head, _ = gru(x[:, :1], h0, *weights.values())
    tail, _ = gru(x[:, 1:], head[:, -1], *weights.values())
    whole, _ = gru(x, h0, *weights.values())
    yield Finding("in two pieces the value", np.concatenate([head, tail], axis=1), whole)


def _zero_at_the_target(mean_squared_error, case, x_hat, x):
    loss, pullback = mean_squared_error(x.copy(), x)
    yield Finding("at the target the loss", loss, 0.0, 0)
    dloss = comparing.drawn_upstream(case, loss)
    yield Finding("at the target the gradient", pullback(dloss), np.zeros_like(x), 0)


def _equal_sets(sliced_wasserstein, case, z, prior, directions):
    loss, pullback = sliced_wasserstein(case.rng().permutation(z), z, directions)
    yield Finding("between equal sets the distance", loss, 0.0)
    yield Finding("between equal sets the gradient", pullback(1.0), np.zeros_like(z))


def _order(sliced_wasserstein, case, z, prior, directions):
    order = case.rng().permutation(len(z))
    loss, pullback = sliced_wasserstein(z, prior, directions)
    again, pullback_again = sliced_wasserstein(z[order], prior[order[::-1]], directions)
    yield Finding("in another order the distance", again, loss)
    if len(np.unique(z + 0.0, axis=0)) == len(z):  # equal points share a gradient in any way
        yield Finding("in another order the gradient", pullback_again(1.0), pullback(1.0)[order])


def _assignment(sliced_wasserstein, case, z, prior, directions):
    cheapest = min(np.mean((np.array(order) - prior) ** 2) for order in permutations(z))
    yield Finding("the distance", sliced_wasserstein(z, prior, np.ones((1, 1)))[0], cheapest)


def _one_by_default(loss, case, **arguments):
    for dtype in (np.float64, np.float32):
        _, pullback = loss(*(array.astype(dtype) for array in arguments.values()))
        by_default = pullback()
        of_one = pullback(1.0)
        yield Finding("by default the gradient", by_default, of_one, 0)
        yield Finding(
            "by default the gradient's bytes a number", by_default.itemsize, of_one.itemsize, 0
        )


_OF_SEQUENCES = (_shift, _causality, _kept_state, _pair_sums, _empty_slot, _own_inverse)
_OF_POINTS = (_equal_sets, _order, _assignment)
_OTHERS = (_inverse_of_tanh, _zero_at_the_target, _one_by_default)
FINDINGS = {f.__name__[1:]: f for f in (*_OF_SEQUENCES, *_OF_POINTS, *_OTHERS)}
"""FINDINGS: the functions above by the name that a row of the table calls them."""
