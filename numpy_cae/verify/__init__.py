"""Gradients that a stranger can trust: every operation's properties, for anyone's implementation.

Everything here takes operations in the form of `numpy_cae.ops`: a function that returns its value
and its pullback. `check_gradients` and `check_adjoint` raise with a readable report; `properties`
is what is known of each operation, as data; `report` holds an implementation to all of it, and
`numpy-cae verify student.py` does the same to a file in a process of its own.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from numpy_cae.verify.adjoint import check_adjoint
from numpy_cae.verify.catalogue import properties
from numpy_cae.verify.gradients import check_gradients

if TYPE_CHECKING:
    from numpy_cae.verify.reporting import Report

__all__ = ["check_adjoint", "check_gradients", "properties", "report"]


def report(implementation: Callable, as_: str | None = None) -> Report:
    """Hold an implementation to every property of its operation.

    Parameters
    ----------
    implementation : callable
        With the arguments of the operation in `numpy_cae.ops`; returns a value and its pullback.
    as_ : str, optional
        The operation that it implements; by default the one whose name it bears.

    Returns
    -------
    Report
        Prints as a table; `.points`, `.possible`, `.held`, `.outcomes`.

    Raises
    ------
    ValueError
        If there is no such operation.
    ImportError
        If hypothesis, which draws the examples, is not installed.
    """
    from numpy_cae.verify.reporting import report_on, require_operation

    called = getattr(implementation, "__name__", "implementation")
    operation = called if as_ is None else as_
    require_operation(operation)
    return report_on(implementation, operation, called)
