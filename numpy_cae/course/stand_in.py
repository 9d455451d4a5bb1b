"""The package's own function in place of one that a student has not written."""

from collections.abc import Callable
from functools import wraps
from inspect import signature

from numpy_cae.course.catalogue import CATALOGUE


def unsolved(*arguments):
    """What is tested in place of a function that a student has not written."""
    raise NotImplementedError


def stand_in(name: str, attempt: Callable = unsolved) -> Callable:
    """The package's own function, marked as such.

    Parameters
    ----------
    name : str
        An operation or exercise.
    attempt : callable, optional
        The student's last function, for which `course.report` shows hints.
    """
    solution = CATALOGUE[name].solution

    @wraps(solution)
    def standing_in(*arguments, **named):
        return solution(*arguments, **named)

    attributes = vars(standing_in)
    del attributes["__wrapped__"]  # `name??` in a notebook would show the solution
    attributes["__signature__"] = signature(solution)
    attributes["attempt"] = attempt
    standing_in.__name__ = name
    return standing_in


def is_stand_in(function: object) -> bool:
    """Whether a function is the package's own in place of a student's."""
    return hasattr(function, "attempt")


def attempt_of(function: Callable) -> Callable:
    """The student's function: what a stand-in is in place of, any other function itself."""
    return getattr(function, "attempt", function)
