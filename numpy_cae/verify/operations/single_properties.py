"""Properties of single operations: ties, bounds, limits, zeros.

They are rows of the table `operations.toml`. Where a property says what the definition returns for
one class of values, it has no function of its own.
"""

from collections.abc import Callable, Iterator

import numpy as np

from numpy_cae.verify.operations import property as comparing
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation import TABLE, Operation, sizes_of
from numpy_cae.verify.operations.property import Pair, Pairs, Property


def single_properties(operation: Operation) -> Iterator[Property]:
    """The properties that only this operation has."""
    for row in TABLE["properties"]:
        if operation.name in row["operations"].split():
            pairs = OWN_CHECKS.get(row["name"], comparing.compared)
            classes = comparing.UPSTREAM | sizes_of(row.get("sizes", {}))
            stated = row["name"], row["statement"]
            yield comparing.property_of(operation, *stated, pairs, classes)


def _zero_at_the_target(operation: Operation, mean_squared_error: Callable, case: Case) -> Pairs:
    x = operation.arguments(case)["x"]
    loss, pullback = mean_squared_error(x.copy(), x)
    yield Pair("at the target the loss", loss, 0.0, 0)
    dloss = comparing.drawn_upstream(case, loss)
    yield Pair("at the target the gradient", pullback(dloss), np.zeros_like(x), 0)


def _one_by_default(operation: Operation, loss: Callable, case: Case) -> Pairs:
    for dtype in (np.float64, np.float32):
        arrays = [array.astype(dtype) for array in operation.arguments(case).values()]
        _, pullback = loss(*arrays)
        by_default = pullback()
        of_one = pullback(1.0)
        yield Pair("by default the gradient", by_default, of_one, 0)
        what = "by default the gradient's bytes a number"
        yield Pair(what, by_default.itemsize, of_one.itemsize, 0)


def _empty_slot(operation: Operation, unpool_random: Callable, case: Case) -> Pairs:
    y, first = operation.arguments(case).values()
    x, _ = unpool_random(y, first)
    yield Pair("the other frame", np.where(first, x[:, 1::2], x[:, 0::2]), np.zeros_like(y), 0)


OWN_CHECKS = {"zero at the target": _zero_at_the_target, "upstream default": _one_by_default}
OWN_CHECKS["empty slot"] = _empty_slot
"""OWN_CHECKS: what is compared for the properties of these names."""
