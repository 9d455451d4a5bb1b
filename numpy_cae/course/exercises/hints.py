"""The hints of the exercises, read from `hints.md`, whose first lines describe its format."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib.resources import files

from numpy_cae.course.exercises.exercise import Exercise


@dataclass(frozen=True)
class Hints:
    """The hint of an exercise, and those of its properties by name."""

    text: str = ""
    of_properties: Mapping[str, str] = field(default_factory=dict)


def read_hints() -> dict[str, Hints]:
    """The hints of every exercise by its name."""
    text = files(__package__).joinpath("hints.md").read_text(encoding="utf-8")
    sections = (section.partition("\n") for section in re.split("^## ", text, flags=re.M)[1:])
    return {name: _parse(section) for name, _, section in sections}


def with_hints(exercise: Exercise, hints: Hints) -> Exercise:
    """The exercise with hints; ValueError if a property of this name does not exist."""
    unknown = hints.of_properties.keys() - {prop.name for prop in exercise.properties}
    if unknown:
        raise ValueError(f"hints for unknown properties of {exercise.name}: {', '.join(unknown)}")
    properties = (replace(p, hint=hints.of_properties.get(p.name, "")) for p in exercise.properties)
    return replace(exercise, properties=tuple(properties), hint=hints.text)


def _parse(section: str) -> Hints:
    text, *items = (" ".join(part.split()) for part in re.split("^- ", section, flags=re.M))
    of_properties = {}
    for names, _, hint in (item.partition(": ") for item in items):
        of_properties |= dict.fromkeys(names.split(", "), hint)
    return Hints(text, of_properties)
