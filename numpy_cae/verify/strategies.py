"""Hypothesis strategies for the arguments of the operations, with every class of value.

from hypothesis import given
from numpy_cae.verify import strategies

@given(strategies.examples("conv1d"))
def test_my_conv1d(example):
    y, pullback = my_conv1d(*example.arguments.values())
    np.testing.assert_allclose(y, example.value)
"""

from functools import partial

from hypothesis import strategies as st

from numpy_cae.verify.catalogue import CATALOGUE, find_task
from numpy_cae.verify.property import UPSTREAM
from numpy_cae.verify.trial import Example, example_of


def examples(name: str) -> st.SearchStrategy[Example]:
    """Arguments of an operation, an upstream gradient, and what the definition makes of them.

    Raises a ValueError if there is no such operation.
    """
    properties = find_task(CATALOGUE, name).properties
    sizes = {**properties[0].sizes, **UPSTREAM}
    drawn = st.fixed_dictionaries({size: st.sampled_from(among) for size, among in sizes.items()})
    return st.builds(partial(example_of, properties), st.integers(0, 9999), drawn)


def arguments(name: str) -> st.SearchStrategy[dict[str, object]]:
    """The arguments of an operation by name, in the order of the call."""
    return examples(name).map(lambda example: example.arguments)
