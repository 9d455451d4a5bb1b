"""The hints of the exercises, which `lesson_NN.toml` states."""

from dataclasses import replace
from functools import cache

from numpy_cae.course.exercises.entries import NUMBERS, entries_of
from numpy_cae.verify.operations.catalogue import Exercise


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
