"""The hints of the exercises, read from `hints.md`, whose first lines describe its format."""

import re
from dataclasses import replace
from functools import cache
from importlib.resources import files
from typing import NamedTuple

from numpy_cae.verify.operations.catalogue import Exercise


class Hints(NamedTuple):
    """The two hints of an exercise, and those of its properties by name."""

    stages: tuple[str, ...]
    of_properties: dict[str, str]


@cache
def read_hints() -> dict[str, Hints]:
    """The hints of every exercise by its name."""
    text = files(__package__).joinpath("hints.md").read_text(encoding="utf-8")
    sections = (section.partition("\n") for section in re.split("^## ", text, flags=re.M)[1:])
    return {name: _parse(section) for name, _, section in sections}


def with_hint(exercise: Exercise, stage: int) -> Exercise:
    """The exercise with a hint that a report shows; at stage 0, how to get a hint.

    Raises a ValueError if there is no such stage.
    """
    if stage not in (0, 1, 2):
        raise ValueError(f"hint is 1 or 2, got {stage!r}")
    hints = read_hints().get(exercise.name)
    if hints is None:
        return exercise
    if stage == 0:
        more = f'course.report("{exercise.name}", {exercise.name}, hint=1) in a cell of your own'
        return replace(exercise, hint=f"{more} prints one")
    if stage == 1:
        return replace(exercise, hint=f"{hints.stages[0]} (more: hint=2)")
    properties = (replace(p, hint=hints.of_properties.get(p.name, "")) for p in exercise.properties)
    return replace(exercise, properties=tuple(properties), hint=hints.stages[1])


def _parse(section: str) -> Hints:
    text, *items = re.split("^- ", section, flags=re.M)
    _, *stages = re.split(r"^\d\. ", text, flags=re.M)
    of_properties = {}
    for names, _, hint in (_one_line(item).partition(": ") for item in items):
        of_properties |= dict.fromkeys(names.split(", "), hint)
    return Hints(tuple(map(_one_line, stages)), of_properties)


def _one_line(text: str) -> str:
    return " ".join(text.split())
