"""What the cells of a notebook call: reports on a student's functions, and what comes after."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import replace
from pathlib import Path

from numpy_cae.course.catalogue import CATALOGUE, EXERCISES, LESSONS
from numpy_cae.course.exercises.exercise import MAKES, with_hint
from numpy_cae.course.feedback import Feedback, Printed
from numpy_cae.course.mine import FILE, NotSavedError, run, save, stand_in
from numpy_cae.verify.grading.report import holds
from numpy_cae.verify.grading.report import report as report_on
from numpy_cae.verify.operations.catalogue import example as example_of
from numpy_cae.verify.operations.catalogue import find_exercise


def report(name: str, function: Callable, hint: int = 0) -> Feedback | int:
    """Test a student's function for every property of an operation or an exercise.

    While nbgrader runs the notebook, the report is printed and its points are returned, because
    nbgrader takes a number that a check cell returns as the points of the exercise. The points are
    those of `numpy-cae verify`.

    In a notebook the report is shown where it is the last line of a cell; in a script nothing is
    shown: `print(course.report(name, function))`.

    Of what the function prints in the tests, the first lines are shown above the report. Where
    `solved` replaced the function by the package's own, the one that it replaced is tested.

    After a first attempt, `hint=1` adds a hint to the report and `hint=2` a second one. Raises a
    ValueError if there is no such operation or exercise, or no such hint.
    """
    exercise = find_exercise(name, CATALOGUE)
    called = None
    if hasattr(function, "stands_in"):
        called = name
        function = function.tried
        if function is None:
            print(f"{name} is the package's own now: run the cell with your function again first")
            function = _unsolved
    if os.environ.get("NBGRADER_EXECUTION"):
        with redirect_stdout(Printed()), redirect_stderr(Printed()):  # it would give 0 points
            tested = report_on(exercise, function, called=called)
        print(tested)
        return tested.points
    with redirect_stdout(Printed()) as printed:
        tested = report_on(with_hint(exercise, hint), function, called=called)
    print(printed, end="")
    if tested.unsolved:
        later = "a hint is shown after your first attempt" if hint else ""
        tested = replace(tested, exercise=replace(tested.exercise, hint=later))
    return Feedback(tested.exercise, tested.called, tested.outcomes)


def solved(name: str, function: Callable) -> Callable:
    """The function for later cells: the student's if every property holds, else the package's own.

    If the folder of the notebook has a file mine.py, the student's function is saved to it for
    later lessons. Prints what is done; raises a ValueError if there is no such exercise.
    """
    if name not in EXERCISES:
        raise ValueError(f"no exercise is called {name!r}; there are {', '.join(EXERCISES)}")
    with redirect_stdout(Printed()):
        is_right = not hasattr(function, "stands_in") and holds(EXERCISES[name], function)
    if not is_right:
        again = "run this cell again when yours is right"
        print(f"{name}: the next cells use the package's own; {again}")
        return function if hasattr(function, "stands_in") else stand_in(name, function)
    try:
        with redirect_stdout(Printed()):  # the cell is run again
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


def progress() -> None:
    """Print how many functions mine.py has, what the finished lessons make, and what is next."""
    mine: set[str] = set()
    with suppress(FileNotFoundError, NotSavedError, UnicodeDecodeError):
        mine = set(run(Path(FILE).read_text(encoding="utf-8"))) & set(EXERCISES)
    missing = {n: {task.name for task in tasks} - mine for n, tasks in LESSONS.items()}
    made = [MAKES[number] for number, names in missing.items() if not names]
    print(f"{len(mine)} of {len(EXERCISES)} functions are yours")
    if made:
        print(f"They add up to: {', '.join(made)}.")
    if after := next((number for number, names in missing.items() if names), None):
        print(f"Next: {MAKES[after]} (lesson {after}).")


def _unsolved(*arguments):
    raise NotImplementedError
