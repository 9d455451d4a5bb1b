"""The catalogue of the course: every exercise with its points and its known mistakes.

Check cells, the tests and grading all use it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from numpy_cae.course.exercises.entries import NUMBERS, entries_of
from numpy_cae.course.exercises.exercise import exercises_of
from numpy_cae.course.exercises.lesson_12 import VERDICTS
from numpy_cae.course.mistakes import likely_mistake
from numpy_cae.verify.operations import catalogue as operations
from numpy_cae.verify.operations.catalogue import Exercise
from numpy_cae.verify.operations.diagnosis import misplaced_gradient
from numpy_cae.verify.operations.property import Property

SHOWN_BY = {VERDICTS.operation: VERDICTS}
"""SHOWN_BY: what shows which mistake an exercise has, where a property that fails does not."""
SHARES = {0: 0.4, 1: 0.4, 2: 0.2}
"""SHARES: the parts of an exercise's points for its value, its gradients and the rest. If an
exercise has no gradients or no rest, the value has their part, too."""


def with_points(exercise: Exercise, total: int) -> Exercise:
    """The exercise with its points.

    Properties of one group of `SHARES` have equal points, except that "value" has as many as all
    others of its group together.
    """
    groups = [stated.group for stated in exercise.properties]
    shares = {group: SHARES[group] for group in set(groups)}
    shares[0] += 1 - sum(shares.values())
    weights = [
        max(1, groups.count(0) - 1) if stated.name == "value" else 1
        for stated in exercise.properties
    ]
    of_group = {g: sum(w for w, of in zip(weights, groups, strict=True) if of == g) for g in shares}
    points = (total * shares[g] * w / of_group[g] for w, g in zip(weights, groups, strict=True))
    diagnose = None if exercise.name in operations.CATALOGUE else diagnosis(exercise)
    properties = (
        replace(stated, points=number, diagnose=diagnose)
        for stated, number in zip(exercise.properties, points, strict=True)
    )
    return replace(exercise, properties=tuple(properties))


def diagnosis(exercise: Exercise) -> Callable[[Property, Callable], str]:
    """The function that names the mistake in an implementation of an exercise, or ""."""

    def diagnose(stated: Property, implementation: Callable) -> str:
        shown_by = SHOWN_BY.get(stated.operation, stated)
        mistake = likely_mistake(shown_by, implementation, exercise.solution)
        operation = getattr(stated.check, "operation", None)
        if mistake or operation is None:
            return mistake
        return misplaced_gradient(stated, operation, implementation)

    return diagnose


LESSONS: dict[str, tuple[Exercise, ...]] = {
    number: tuple(
        with_points(each, entries_of(number)[each.name]["points"]) for each in exercises_of(number)
    )
    for number in NUMBERS
}

EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise for lesson in LESSONS.values() for exercise in lesson
}

CATALOGUE = {**operations.CATALOGUE, **EXERCISES}

ASSIGNMENTS = {number: tuple(task.name for task in tasks) for number, tasks in LESSONS.items()}
"""The names of the exercises of each lesson, by the number of the lesson."""
