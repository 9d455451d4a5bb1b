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

__all__ = ["check_adjoint", "check_gradients", "example", "properties", "report"]


def properties(name: str) -> tuple[Property, ...]:
    """The properties of an operation of `numpy_cae.ops` or of "tied_layer", else a ValueError."""
    from numpy_cae.verify.catalogue import CATALOGUE, find_task

    return find_task(CATALOGUE, name).properties


def report(name: str, function: Callable) -> Report:
    """Test an implementation for every property of an operation.

    Parameters
    ----------
    name : str
        An operation of `numpy_cae.ops`, or "tied_layer".
    function : callable
        With the arguments of that operation; returns a value and its pullback.

    Returns
    -------
    Report
        Prints as a table; `.points`, `.possible`, `.held`, `.unsolved`, `.outcomes`.

    Raises
    ------
    ValueError
        If there is no such operation.
    ImportError
        If hypothesis, which draws the examples, is not installed.
    """
    from numpy_cae.verify.catalogue import CATALOGUE, find_task
    from numpy_cae.verify.reporting import report_on

    return report_on(find_task(CATALOGUE, name), function)


def example(name: str, seed: int, **sizes: int) -> dict[str, object]:
    """The arguments, by name, of a counterexample that a report prints as a call of this function.

    Raises a ValueError if there is no such operation or a size, such as frames=2, is missing.
    """
    from numpy_cae.verify.case import example_of
    from numpy_cae.verify.catalogue import CATALOGUE, find_task

    return example_of(find_task(CATALOGUE, name).properties[0], seed, sizes)
