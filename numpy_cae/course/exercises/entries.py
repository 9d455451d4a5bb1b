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
float32     whether float32 has to stay float32 (`every_exercise.toml`)
pure        false if no argument can be altered (`every_exercise.toml`)
given       what a solution may call: operations, and exercises of earlier lessons
hints       the hints that `course.report` prints with hint=1, a direction, and hint=2
hint_for    with the second hint: the hint of a property that does not hold
properties  the statement of each property, or a table with it and fields of `Property`;
            `gradient` names the arrays whose gradients the property is about, "" being all, and
            `part` the only one of several results that it is about, or the only columns

An exercise without arguments is an operation of `numpy_cae.ops`.
"""

import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path

from numpy_cae.verify.operations.catalogue import Exercise

FOLDER = Path(__file__).parent
NUMBERS = [path.stem.removeprefix("lesson_") for path in sorted(FOLDER.glob("lesson_*.toml"))]
"""NUMBERS: the lessons, 00 to 14, in their order."""


@cache
def entries_of(number: str) -> dict[str, dict]:
    """The entries of each exercise of a lesson, by name."""
    every = read_table(f"lesson_{number}").items()
    return {name: each for name, each in every if isinstance(each, dict)}


def made_by(number: str) -> str:
    """What the exercises of a lesson add up to."""
    return read_table(f"lesson_{number}")["makes"]


@cache
def hints_of(name: str) -> tuple[list[str], dict[str, str]]:
    """The two hints of an exercise, and those of its properties by name; none of others."""
    entries = next((entries_of(n)[name] for n in NUMBERS if name in entries_of(n)), {})
    stages = [" ".join(hint.split()) for hint in entries.get("hints", ())]
    return stages, {n: " ".join(hint.split()) for n, hint in entries.get("hint_for", {}).items()}


def with_hint(exercise: Exercise, stage: int) -> Exercise:
    """The exercise with a hint that a report shows; at stage 0, how to get a hint.

    Raises a ValueError if there is no such stage.
    """
    if stage not in (0, 1, 2):
        raise ValueError(f"hint is 1 or 2, got {stage!r}")
    stages, of_properties = hints_of(exercise.name)
    if not stages:
        return exercise
    if stage == 0:
        more = f'course.report("{exercise.name}", {exercise.name}, hint=1) in a cell of your own'
        return replace(exercise, hint=f"{more} prints one")
    if stage == 1:
        return replace(exercise, hint=f"{stages[0]} (more: hint=2)")
    properties = (replace(p, hint=of_properties.get(p.name, "")) for p in exercise.properties)
    return replace(exercise, properties=tuple(properties), hint=stages[1])


@cache
def read_table(name: str) -> dict:
    """What a text file of this folder states."""
    return tomllib.loads((FOLDER / f"{name}.toml").read_text(encoding="utf-8"))
