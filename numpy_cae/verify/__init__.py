"""Tests of derivatives written by hand: gradient checks, and the properties of each operation.

Everything here takes operations in the form of `numpy_cae.ops`: a function that returns its value
and its pullback. `check_gradients` and `check_adjoint` raise with a readable message;
`properties` lists what must hold of an operation, as data; `report` tests an implementation for
all of it. `numpy-cae verify student.py` does the same to a file, in a process of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from numpy_cae.verify.adjoint import check_adjoint
from numpy_cae.verify.gradients import check_gradients

if TYPE_CHECKING:
    from numpy_cae.verify.property import Property
    from numpy_cae.verify.reporting import Report
    from numpy_cae.verify.trial import Example

__all__ = ["check_adjoint", "check_gradients", "check_property", "example", "properties", "report"]


def properties(name: str) -> tuple[Property, ...]:
    """The properties of an operation of `numpy_cae.ops` or of "tied_layer", else a ValueError."""
    from numpy_cae.verify.catalogue import CATALOGUE, find_task

    return find_task(CATALOGUE, name).properties


def check_property(stated: Property, function: Callable) -> None:
    """Raise an AssertionError with a counterexample unless an implementation has a property.

    For test files: `@pytest.mark.parametrize("prop", verify.properties("gru"))`.
    """
    from numpy_cae.verify.trial import try_property

    outcome = try_property(stated, function)
    if not outcome.held:
        told = (stated.statement, outcome.problem, outcome.counterexample, outcome.mistake)
        raise AssertionError("\n".join(filter(None, told)))


def report(name: str, function: Callable, any_convention: bool = False) -> Report:
    """Test an implementation for every property of an operation.

    Parameters
    ----------
    name : str
        An operation of `numpy_cae.ops`, or "tied_layer".
    function : callable
        With the arguments of that operation; returns a value and its pullback.
    any_convention : bool
        Whether it may follow another documented convention than `numpy_cae.ops`, such as a GRU
        with its gates in another order, or half the mean squared error.

    Returns
    -------
    Report
        Prints as a table; `.points`, `.possible`, `.held`, `.unsolved`, `.outcomes`.

    Raises
    ------
    ValueError
        If there is no such operation.
    """
    from numpy_cae.verify.catalogue import CATALOGUE, find_task
    from numpy_cae.verify.reporting import report_on

    return report_on(find_task(CATALOGUE, name), function, any_convention=any_convention)


def example(name: str, seed: int, **sizes: int | str) -> Example:
    """The example that a report prints as a call of this function.

    Returns
    -------
    Example
        `.arguments` by name, `.upstream`, `.value`, and `.gradients` by argument: the value and
        the gradients are those of the definition.

    Raises
    ------
    ValueError
        If there is no such operation, or a size such as frames=2 is missing or unknown.
    """
    from numpy_cae.verify.catalogue import CATALOGUE, find_task
    from numpy_cae.verify.trial import example_of

    return example_of(find_task(CATALOGUE, name).properties, seed, sizes)
