"""The exercises of the lessons, as data: check cells, the tests and grading all use them."""

from importlib import import_module

from numpy_cae.course.exercises.difficulty import with_points
from numpy_cae.course.exercises.exercise import Exercise
from numpy_cae.verify import catalogue as operations

LESSONS: dict[str, tuple[Exercise, ...]] = {
    number: tuple(map(with_points, import_module(f"{__name__}.lesson_{number}").EXERCISES))
    for number in (f"{n:02}" for n in range(15))
}

EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise for lesson in LESSONS.values() for exercise in lesson
}

CATALOGUE = {**operations.CATALOGUE, **EXERCISES}

__all__ = ["CATALOGUE", "EXERCISES", "LESSONS", "Exercise"]
