"""The catalogue of the course: every exercise with its points and its known mistakes.

Check cells, the tests and grading all use it.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from numpy_cae.course.exercises.exercise import ENTRIES, MAKES, exercises_of
from numpy_cae.course.likely_mistakes import diagnose_exercise
from numpy_cae.course.points import share_points
from numpy_cae.course.submitted_file import read_for_lesson
from numpy_cae.verify.grading.submission import Submission
from numpy_cae.verify.operations import operation_catalogue
from numpy_cae.verify.operations.operation_catalogue import Exercise


def with_points(exercise: Exercise, total: int) -> Exercise:
    """The exercise with its points, and with the function that names a mistake in it."""
    points = share_points(exercise.properties, total)
    diagnose = None
    if exercise.name not in operation_catalogue.CATALOGUE:
        diagnose = diagnose_exercise(exercise)
    properties = [
        replace(tested, points=number, diagnose=diagnose)
        for tested, number in zip(exercise.properties, points, strict=True)
    ]
    return replace(exercise, properties=tuple(properties))


def _lesson_exercises(number: str) -> tuple[Exercise, ...]:
    return tuple(
        with_points(exercise, ENTRIES[exercise.name]["points"]) for exercise in exercises_of(number)
    )


LESSONS: dict[str, tuple[Exercise, ...]] = {number: _lesson_exercises(number) for number in MAKES}

EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise for exercises in LESSONS.values() for exercise in exercises
}

CATALOGUE = {**operation_catalogue.CATALOGUE, **EXERCISES}

ASSIGNMENTS = {
    number: tuple(exercise.name for exercise in exercises) for number, exercises in LESSONS.items()
}
"""The names of the exercises of each lesson, by the number of the lesson."""


def read_submission(path: Path) -> Submission:
    """Read what a student has handed in for one of the lessons."""
    return read_for_lesson(path, ASSIGNMENTS)
