"""Gradients that a stranger can trust: every operation's properties, for anyone's implementation.

Everything here takes operations in the form of `numpy_cae.ops`: a function that returns its value
and its pullback. `check_gradients` and `check_adjoint` raise with a readable report; `properties`
is what is known of each operation, as data; `report` holds an implementation to all of it, and
`numpy-cae verify student.py` does the same to a file in a process of its own.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import wraps
from typing import TYPE_CHECKING

from numpy_cae.verify.adjoint import check_adjoint
from numpy_cae.verify.catalogue import properties
from numpy_cae.verify.gradients import check_gradients

if TYPE_CHECKING:
    from numpy_cae.verify.reporting import Report

__all__ = ["check_adjoint", "check_gradients", "example", "properties", "report", "solved"]


def report(implementation: Callable, as_: str | None = None) -> Report:
    """Hold an implementation to every property of its operation, or of an exercise of a lesson.

    Parameters
    ----------
    implementation : callable
        With the arguments of the operation in `numpy_cae.ops`; returns a value and its pullback.
    as_ : str, optional
        The operation or exercise that it implements; by default the one whose name it bears.

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
    from numpy_cae.verify.reporting import report_on, require_operation

    called = getattr(implementation, "__name__", "implementation")
    operation = called if as_ is None else as_
    require_operation(operation)
    if hasattr(implementation, "stands_in"):
        print(f"{called} is the package's own at present: run the cell with yours again first")
        implementation = _unsolved
    made = report_on(implementation, operation, called)
    if os.environ.get("NBGRADER_EXECUTION") and not made.held:
        raise AssertionError(str(made))  # to nbgrader, a cell that raises is one that failed
    return made


def example(of: str, seed: int, **sizes: int) -> dict[str, object]:
    """The arguments of a counterexample, as a report that fails writes it.

    Parameters
    ----------
    of : str
        The operation or exercise.
    seed : int
    **sizes : int
        Such as frames=2, all that the report names.

    Returns
    -------
    dict of argument names to arrays and numbers

    Raises
    ------
    ValueError
        If there is no such operation or exercise, or a size is missing.
    """
    from numpy_cae.verify.case import Case
    from numpy_cae.verify.reporting import require_operation, stated_of

    require_operation(of)
    tried = stated_of(of)[0]
    if set(sizes) != set(tried.sizes):
        raise ValueError(f"{of} has the sizes {', '.join(tried.sizes)}, got {', '.join(sizes)}")
    return tried.arguments(Case(tuple(sizes.items()), seed))


def solved(implementation: Callable, as_: str | None = None) -> Callable:
    """A lesson's exercise as later cells use it: the student's own where it holds, else ours.

    Says in a line which it is.

    Parameters
    ----------
    implementation : callable
    as_ : str, optional
        The exercise; by default the one whose name it bears.

    Returns
    -------
    callable
        The implementation if every property holds, else the package's own solution.

    Raises
    ------
    ValueError
        If there is no such exercise.
    """
    from numpy_cae.course.exercises import EXERCISES
    from numpy_cae.verify import reporting

    name = getattr(implementation, "__name__", "") if as_ is None else as_
    if name not in EXERCISES:
        raise ValueError(f"no exercise is called {name!r}; there are {', '.join(EXERCISES)}")
    if reporting.solved(implementation, name):
        print(f"{name}: from here on, yours")
        return implementation
    print(f"{name}: from here on, the package's own; run this cell again when yours holds")
    return _stand_in(EXERCISES[name].solution, name)


def _stand_in(solution: Callable, name: str) -> Callable:
    """The package's solution, marked, lest a check that is run again take it for the student's."""

    @wraps(solution)
    def standing_in(*arguments, **named):
        return solution(*arguments, **named)

    standing_in.__name__ = name
    standing_in.stands_in = True
    return standing_in


def _unsolved(*arguments):
    raise NotImplementedError
