"""Every operation has every property that is listed for it in `numpy_cae.verify`.

Among them: finite differences for every argument, the exact adjoint of the linear operations,
definitions by loops, unchanged arguments, dtype, strides.
"""

import pytest
from hypothesis import settings

from numpy_cae import ops
from numpy_cae.verify.catalogue import CATALOGUE
from numpy_cae.verify.tied import tied_layer
from numpy_cae.verify.trial import try_property


def test_no_operation_is_left_out():
    assert set(CATALOGUE) == set(ops.__all__) | {"tied_layer"}


@pytest.mark.parametrize(
    "tried",
    [tried for task in CATALOGUE.values() for tried in task.properties],
    ids=lambda tried: f"{tried.operation}: {tried.name}",
)
def test_it_holds(tried):
    implementation = getattr(ops, tried.operation, tied_layer)
    outcome = try_property(tried, implementation, settings.default.max_examples // 2)
    assert outcome.held, f"{outcome.problem}\n{outcome.counterexample}\n{outcome.mistake}"
