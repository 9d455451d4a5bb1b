"""What the cells of a notebook call: reports on a student's functions, and what comes after.

A notebook shows a report in colours, the rest folded, and what the function printed.
"""

from __future__ import annotations

import io
import os
import re
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import replace
from html import escape
from pathlib import Path

from numpy_cae.course.catalogue import CATALOGUE, EXERCISES, LESSONS
from numpy_cae.course.exercises.exercise import MAKES, with_hint
from numpy_cae.course.mine import FILE, NotSavedError, run, save, stand_in, unsolved
from numpy_cae.verify.grading.report import Report, holds
from numpy_cae.verify.grading.report import report as report_on
from numpy_cae.verify.operations.catalogue import example as example_of
from numpy_cae.verify.operations.catalogue import find_exercise

MOST_LINES = 10
LONGEST_KEPT = 4000
"""MOST_LINES: what a function prints is shown so far; it is tested with hundreds of arrays."""
RIGHT, WRONG, OPEN = "#1b7a3d", "#b3261e", "#5f6368"
TITLE = '<b style="background:{};color:white;border-radius:3px;padding:0 .4em">{}</b>'
TEXT = '<pre style="white-space:pre-wrap;margin:.2em 0">{}</pre>'
FOLDED = "<details><summary>{}</summary>{}</details>"


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
        if function is unsolved:
            print(f"{name} is the package's own now: run the cell with your function again first")
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


class Printed(io.TextIOBase):
    """A stream that keeps the beginning of what is printed and counts the lines."""

    def __init__(self) -> None:
        self.kept = ""
        self.lines = 0

    def write(self, text: str) -> int:
        self.kept = (self.kept + text)[:LONGEST_KEPT]
        self.lines += text.count("\n")
        return len(text)

    def __str__(self) -> str:
        first = self.kept.splitlines()[:MOST_LINES]
        more = self.lines - len(first)
        tail = [f"... {more} more lines: your function is called many times"] * (more > 0)
        return "".join(f"{line}\n" for line in first + tail)


class Feedback(Report):
    """A report as a notebook shows it."""

    def __str__(self) -> str:
        return super().__str__().replace(' example("', ' course.example("')

    __repr__ = __str__

    def _repr_html_(self) -> str:
        title, *items = re.split(r"\n(?=  \S)", str(self))
        colour = RIGHT if self.held else OPEN if self.unsolved else WRONG
        title = TITLE.format(colour, escape(" ".join(title.split())))
        if self.held:
            statements = (f"{o.stated.name}: {o.stated.statement}" for o in self.outcomes)
            return title + FOLDED.format("what was checked", _text("\n".join(statements)))
        hints = [_text(items.pop())] if self.exercise.hint else []
        first, *others = items
        more = FOLDED.format("other properties, points", _text("\n".join(others)))
        return "".join([title, _text(first), more, *hints])

    def __dir__(self) -> list[str]:
        """What tab completion offers: the exercise, with its solution, is not among it."""
        return ["held", "points", "possible"]


def _text(text: str) -> str:
    return TEXT.format(escape(text))
