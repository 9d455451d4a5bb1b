"""The hints of the exercises, read from `hints.md`, whose first lines describe its format."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files

from numpy_cae.verify.catalogue import Task

STAGES = 2


@dataclass(frozen=True)
class Hints:
    """The hints of an exercise, the first one first, and those of its properties by name."""

    stages: tuple[str, ...] = ()
    of_properties: Mapping[str, str] = field(default_factory=dict)


@cache
def read_hints() -> dict[str, Hints]:
    """The hints of every exercise by its name."""
    text = files(__package__).joinpath("hints.md").read_text(encoding="utf-8")
    sections = (section.partition("\n") for section in re.split("^## ", text, flags=re.M)[1:])
    return {name: _parse(section) for name, _, section in sections}


def with_hint(task: Task, stage: int) -> Task:
    """The task with a hint, which a report shows: of stage 0, how to get one. Raises ValueError if
    there is no such stage, or hints.md names a property that the task does not have."""
    hints = read_hints().get(task.name, Hints())
    if stage not in range(STAGES + 1):
        raise ValueError(f"hint is 1 or {STAGES}, got {stage!r}")
    if not hints.stages:
        return task
    unknown = hints.of_properties.keys() - {prop.name for prop in task.properties}
    if unknown:
        raise ValueError(f"hints for unknown properties of {task.name}: {', '.join(unknown)}")
    more = f'course.report("{task.name}", {task.name}, hint={stage + 1}) in a cell of your own'
    if stage == 0:
        return replace(task, hint=f"{more} prints one")
    if stage < STAGES:
        return replace(task, hint=f"{hints.stages[stage - 1]} (more: hint={stage + 1})")
    properties = (replace(p, hint=hints.of_properties.get(p.name, "")) for p in task.properties)
    return replace(task, properties=tuple(properties), hint=hints.stages[stage - 1])


def _parse(section: str) -> Hints:
    text, *items = re.split("^- ", section, flags=re.M)
    _, *stages = re.split(r"^\d\. ", text, flags=re.M)
    of_properties = {}
    for names, _, hint in (_one_line(item).partition(": ") for item in items):
        of_properties |= dict.fromkeys(names.split(", "), hint)
    return Hints(tuple(map(_one_line, stages)), of_properties)


def _one_line(text: str) -> str:
    return " ".join(text.split())
