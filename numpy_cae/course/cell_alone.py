"""A student's function as the grader has it: the definitions of its cell, and nothing else.

The notebook's kernel knows more than the grader: helpers in other cells, other lessons' functions.
So a function is tested as its cell alone defines it, with the names that the lesson provides.
"""

import ast
import linecache
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from numpy_cae.confined.process import DO_THE_EXERCISE
from numpy_cae.course.catalogue import CATALOGUE, LESSONS
from numpy_cae.course.mine_file import definitions_of, global_names
from numpy_cae.course.submitted_file import MAGIC
from numpy_cae.verify.checks.messages import file_of

NOTEBOOK = "__main__"
"""The module of what the cells of a notebook define."""


class Graded(NamedTuple):
    """A function as the grader has it.

    Attributes
    ----------
    function : callable
    problems : list of str
        What is wrong with its cell, for the student.
    has_points : bool
        False for an attempt under another name, which the grader does not look for.
    """

    function: Callable
    problems: list[str]
    has_points: bool = True


def as_graded(name: str, function: Callable) -> Graded:
    """The function as the grader has it, and what is wrong with the cell, for the student.

    Parameters
    ----------
    name : str
        An exercise, or an operation.
    function : callable
        A function that a cell of the notebook defines. One of another origin, such as a module, is
        returned as it is. One of another name, such as an attempt, is returned as its cell defines
        it, without points.
    """
    cell = _cell_of(function)
    if cell is None:
        return Graded(function, [])
    space = _names_provided(name)
    try:
        tree = ast.parse(cell)
        refused = _refused_import(tree)
        exec(compile(definitions_of(tree, name), file_of(function), "exec"), space)
    except Exception as error:
        return Graded(function, [f"the cell of {name} cannot be run alone: {error}"])
    if refused:
        problem = f"the grader refuses the import of {refused}: write {name} by hand"
        return Graded(_raise(ImportError(f"{refused} may not be imported")), [problem])
    alone = space.get(name)
    if not callable(alone):
        problem = f"no points: the grader tests what a `def {name}` defines, and the cell has none"
        attempt = space.get(function.__name__)
        if not callable(attempt):
            attempt = _raise(NameError(f"it has no function {name}"))
        return Graded(attempt, [problem], has_points=False)
    code = getattr(alone, "__code__", None)
    if code is None:
        return Graded(alone, [])
    missing = [used for used in global_names(code) if used not in space]
    elsewhere = [used for used in missing if used in getattr(function, "__globals__", {})]
    problems = []
    for used in dict.fromkeys(elsewhere):
        problems.append(
            f"{used} is defined in another cell. The grader and later lessons have the cell of "
            f"{name} alone: define {used} in it"
        )
    return Graded(alone, problems)


def _cell_of(function: Callable) -> str | None:
    """The text of the cell that defines a function; None for a function of another origin."""
    if getattr(function, "__module__", None) != NOTEBOOK or not hasattr(function, "__code__"):
        return None
    lines = linecache.getlines(file_of(function))  # IPython has a file name for each cell
    return MAGIC.sub("pass", "".join(lines)) if lines else None


def _names_provided(name: str) -> dict[str, object]:
    """What the grader provides: NumPy, the lesson's other functions, and what they may call."""
    space: dict[str, object] = {"__name__": NOTEBOOK, "np": np}
    lesson = [exercise for exercise in CATALOGUE.values() if exercise.name == name]
    for exercises in LESSONS.values():
        if any(exercise.name == name for exercise in exercises):
            lesson = list(exercises)
    for exercise in lesson:
        names = [*exercise.provided, exercise.name]
        space |= {provided: CATALOGUE[provided].solution for provided in names}
    space.pop(name)
    return space


def _refused_import(tree: ast.Module) -> str:
    """The module that the grader refuses to import, or ""."""
    for node in ast.walk(tree):
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [node.module]
        for module in names:
            if module.partition(".")[0] in DO_THE_EXERCISE:
                return module
    return ""


def _raise(error: Exception) -> Callable:
    """A function that raises an error, as every call does in the grader."""

    def fail(*arguments: object) -> None:
        raise error

    return fail
