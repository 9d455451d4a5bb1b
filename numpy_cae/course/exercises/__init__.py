"""The exercises of the lessons, as data: what a check cell, the tests and a grader all run.

This folder alone in `verify` stands above the other rooms, whose functions solve its exercises.
"""

from __future__ import annotations

from numpy_cae.course.exercises import (
    lesson_01,
    lesson_02,
    lesson_03,
    lesson_04,
    lesson_05,
    lesson_06,
    lesson_07,
    lesson_08,
    lesson_09,
    lesson_10,
    lesson_11,
    lesson_12,
    lesson_13,
    lesson_14,
)
from numpy_cae.course.exercises.exercise import Exercise

LESSONS: dict[str, tuple[Exercise, ...]] = {
    lesson.__name__.rpartition("_")[2]: lesson.EXERCISES
    for lesson in (
        lesson_01,
        lesson_02,
        lesson_03,
        lesson_04,
        lesson_05,
        lesson_06,
        lesson_07,
        lesson_08,
        lesson_09,
        lesson_10,
        lesson_11,
        lesson_12,
        lesson_13,
        lesson_14,
    )
}

EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise for lesson in LESSONS.values() for exercise in lesson
}

__all__ = ["EXERCISES", "LESSONS", "Exercise"]
