"""The catalogue of the course: operations and exercises, and reports on a student's solutions."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import redirect_stderr
from dataclasses import replace
from typing import TYPE_CHECKING

from numpy_cae.course.exercises import CATALOGUE, EXERCISES, LESSONS
from numpy_cae.course.exercises.hints import with_hint
from numpy_cae.course.mine import FILE, NotSavedError, save, stand_in
from numpy_cae.verify.operations.catalogue import find_exercise
from numpy_cae.verify.operations.trial import example as example_of

if TYPE_CHECKING:
    from numpy_cae.verify.grading.report import Report

ASSIGNMENTS = {number: tuple(task.name for task in tasks) for number, tasks in LESSONS.items()}
"""The names of the exercises of each lesson, by the number of the lesson."""


def report(name: str, function: Callable, hint: int = 0) -> Report | int:
    """Test a student's function for every property of an operation or an exercise.

    While nbgrader runs the notebook, the report is printed and its points are returned, because
    nbgrader takes a number that a check cell returns as the points of the exercise. The points are
    those of `numpy-cae verify`.

    After a first attempt, `hint=1` adds a hint to the report and `hint=2` a second one. Raises a
    ValueError if there is no such operation or exercise, or no such hint.
    """
    from numpy_cae.verify.grading.report import report as report_on

    exercise, called = find_exercise(name, CATALOGUE), None
    if hasattr(function, "stands_in"):
        print(f"{name} is the package's own now: run the cell with your function again first")
        function, called = _unsolved, name
    if os.environ.get("NBGRADER_EXECUTION"):
        with open(os.devnull, "w") as nothing, redirect_stderr(nothing):  # it would give 0 points
            tested = report_on(exercise, function, called=called)
        print(tested)
        return tested.points
    tested = report_on(with_hint(exercise, hint), function, called=called)
    if not tested.unsolved:
        return tested
    later = "a hint is shown after your first attempt" if hint else ""
    return replace(tested, exercise=replace(tested.exercise, hint=later))


def solved(name: str, function: Callable) -> Callable:
    """The function for later cells: the student's if every property holds, else the package's own.

    If the folder of the notebook has a file mine.py, the student's function is saved to it for
    later lessons. Prints what is done; raises a ValueError if there is no such exercise.
    """
    from numpy_cae.verify.grading.report import holds

    if name not in EXERCISES:
        raise ValueError(f"no exercise is called {name!r}; there are {', '.join(EXERCISES)}")
    if hasattr(function, "stands_in") or not holds(EXERCISES[name], function):
        again = "run this cell again when yours is right"
        print(f"{name}: the next cells use the package's own; {again}")
        return stand_in(name)
    try:
        where = f" and later lessons ({FILE})" if save(name, function) else ""
        print(f"{name}: the next cells{where} use your function")
    except NotSavedError as error:
        print(f"{name}: the next cells use your function. It is not saved to {FILE}: {error}")
    return function


def example(name: str, seed: int, **sizes: int) -> dict[str, object]:
    """The arguments of a counterexample by name, for the call that a report prints.

    Raises a ValueError if there is no such operation or exercise, or a size is missing.
    """
    return example_of(find_exercise(name, CATALOGUE), seed, **sizes).arguments


def _unsolved(*arguments):
    raise NotImplementedError
