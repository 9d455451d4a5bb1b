"""What the text files `lesson_NN.toml` state of the exercises of a lesson.

The entry `makes` says what the exercises of the lesson add up to. Each table is an exercise:

points      what the exercise earns
arguments   how each argument is drawn (`arguments.py`), or a function of a `lesson_NN.py`
like        an operation of `numpy_cae.ops` that has the same arguments and sizes
sizes       the options of each size, the simplest first
inputs      the arguments that get a gradient
returns     what the function returns: the value, then `the pullback` or the gradients; without it,
            a function with inputs is an operation that only the lesson has
linear_in   the arguments in which such an operation is linear
float32     whether float32 has to stay float32
pure        false if no argument can be altered
given       what a solution may call: operations, and exercises of earlier lessons
hints       the hints that `course.report` prints with hint=1, a direction, and hint=2
hint_for    with the second hint: the hint of a property that does not hold
properties  the statement of each property, or a table with it and fields of `Property`;
            `gradient` names the arrays whose gradients the property is about, "" being all, and
            `part` the only one of several results that it is about, or the only columns

An exercise without arguments is an operation of `numpy_cae.ops`.
"""

import tomllib
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parent
NUMBERS = [path.stem.removeprefix("lesson_") for path in sorted(FOLDER.glob("lesson_*.toml"))]
"""NUMBERS: the lessons, 00 to 14, in their order."""


@cache
def entries_of(number: str) -> dict[str, dict]:
    """The entries of each exercise of a lesson, by name."""
    return {name: each for name, each in _read(number).items() if isinstance(each, dict)}


def made_by(number: str) -> str:
    """What the exercises of a lesson add up to."""
    return _read(number)["makes"]


@cache
def _read(number: str) -> dict:
    return tomllib.loads((FOLDER / f"lesson_{number}.toml").read_text(encoding="utf-8"))
