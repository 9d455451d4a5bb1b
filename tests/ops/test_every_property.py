"""Every operation has every property that is listed for it in `numpy_cae.verify`.

Among them: finite differences for every argument, the exact adjoint of the linear operations,
definitions by loops, unchanged arguments, dtype, strides.
"""

from dataclasses import replace

import numpy as np
import pytest
import values_by_loops

from numpy_cae import ops
from numpy_cae.verify.operations.operation import OPERATIONS, tied_layer
from numpy_cae.verify.operations.operation_catalogue import CATALOGUE
from numpy_cae.verify.operations.shared_properties import own_properties, shared_properties
from numpy_cae.verify.operations.trial import try_property


def by_loops(operation):
    """The operation without its reference: values from loops, gradients from differences."""
    loops = getattr(values_by_loops, operation.name)
    ordinary = {name: ("ordinary",) for name in ("values", "state") if name in operation.sizes}
    return replace(operation, reference=None, definition=loops, without_ties=ordinary)


def test_no_operation_is_left_out():
    operations = {name for name in ops.__all__ if callable(getattr(ops, name))}
    assert set(CATALOGUE) == operations | {"tied_layer"}


@pytest.mark.filterwarnings(  # spurious, on a loaded machine; a nan in the result fails
    "ignore:invalid value encountered in matmul:RuntimeWarning"
)
@pytest.mark.parametrize(
    "tried",
    [
        tried
        for operation in OPERATIONS.values()
        for tried in (*shared_properties(by_loops(operation)), *own_properties(operation))
    ],
    ids=lambda tried: f"{tried.operation}: {tried.name}",
)
def test_it_holds(tried):
    """Without a reference, values are compared with loops and gradients with differences."""
    outcome = try_property(tried, getattr(ops, tried.operation, tied_layer))
    assert outcome.held, f"{outcome.problem}\n{outcome.counterexample}\n{outcome.mistake}"


def gradient(operation, *arguments):
    value, pullback = operation(*(np.array(a) if isinstance(a, list) else a for a in arguments))
    return pullback(np.ones_like(value)).ravel().tolist()


def test_gradients_where_differences_cannot_tell():
    assert gradient(ops.max_pool, [[[1.0], [1.0], [0.0], [-0.0]]]) == [1, 0, 1, 0]
    assert gradient(ops.max_pool, [[[1.0], [1.0 + 1e-9]]]) == [0, 1]
    assert gradient(ops.mean_absolute, [0.0, -0.0, 1e-300, -1e-300]) == [0, 0, 0.25, -0.25]
    assert gradient(ops.mean_squared_error, [0.5, 1.0], np.array([0.5, 0.0])) == [0, 1]
    at_bound = [0.5, -0.5, np.nextafter(0.5, 1), -np.nextafter(0.5, 1), 1.0, -7.0]
    inside = 1 / (1 - 0.25)
    assert gradient(ops.arctanh, at_bound, 0.5) == [inside, inside, 0, 0, 0, 0]
    assert gradient(ops.tanh, [1000.0, -1000.0, 0.0]) == [0, 0, 1]
    assert gradient(ops.sigmoid, [1000.0, -1000.0, 0.0]) == [0, 0, 0.25]
