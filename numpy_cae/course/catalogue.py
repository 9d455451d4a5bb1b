"""The catalogue of the course: every exercise with its points and its known mistakes.

Check cells, the tests and grading all use it.

The likely mistake in an exercise that is no operation is a wrong function that does the same. The
folder `known_mistakes` has a text file for each exercise: patches of its solution in the form
of `numpy_cae.verify.operations.patch`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from numpy_cae.course.exercises.checks import arrays_in
from numpy_cae.course.exercises.exercise import ENTRIES, MAKES, exercises_of
from numpy_cae.course.exercises.gradient_trials import VERDICTS
from numpy_cae.verify.operations import catalogue as operations
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.catalogue import Exercise
from numpy_cae.verify.operations.patch import Patch, patches_in
from numpy_cae.verify.operations.property import Property, failing_case, failure
from numpy_cae.verify.operations.trial import SEVERAL, misplaced_gradient, same

FOLDER = Path(__file__).parent / "known_mistakes"


def likely_mistake(stated: Property, implementation: Callable, exercise: Exercise) -> str:
    """The sentence on the mistake because of which a property does not hold, or "".

    It is named only if the wrong function does in every case of the property what the
    implementation does, the solution in several cases does not, and the implementation fails where
    the mistake is caught, too.
    """
    caught_by = {each.name: each for each in exercise.properties}
    cases = stated.cases()
    for observed in (_of_one_call, _of_every_call):
        results = [observed(stated, implementation, case) for case in cases]
        right = (observed(stated, exercise.solution, case) for case in cases)
        if sum(not same(*pair) for pair in zip(results, right, strict=True)) < SEVERAL:
            continue  # it fails with other arguments, which the check makes of the case's
        for patch in patches_of(stated.operation):
            wrong = wrong_function(patch, exercise.solution)
            others = (observed(stated, wrong, case) for case in cases)
            does_the_same = all(same(*pair) for pair in zip(results, others, strict=False))
            if does_the_same and failing_case(caught_by[patch.caught_by], implementation):
                return patch.sentence
    return ""


@cache
def patches_of(name: str) -> tuple[Patch, ...]:
    """The known mistakes in an exercise, as patches of its solution."""
    path = FOLDER / f"{name}.txt"
    return tuple(patches_in(path.read_text("utf-8"), name)) if path.is_file() else ()


wrong_function = cache(Patch.applied_to)
"""wrong_function(patch, solution): the solution with a known mistake."""


def _of_one_call(stated: Property, function: Callable, case: Case) -> list[np.ndarray]:
    """All that a call with the case's arguments returns, and the arguments afterwards."""
    given = list(stated.arguments(case).values())
    try:
        with np.errstate(all="ignore"):
            return arrays_in([function(*given), given], case)
    except (Exception, SystemExit) as error:
        return [_named(error)]


def _of_every_call(stated: Property, function: Callable, case: Case) -> list[np.ndarray]:
    """All that the calls of the property's check return."""
    seen: list[np.ndarray] = []

    def recorded(*arguments):
        try:
            returned = function(*arguments)
        except Exception as error:
            seen.append(_named(error))
            raise
        seen.extend([np.array("returned"), *arrays_in([returned, arguments], case)])
        return returned

    failure(stated, recorded, case)
    return seen


def _named(error: BaseException) -> np.ndarray:
    """The error by its type and text; of an AssertionError, the text is the student's own."""
    is_own = isinstance(error, AssertionError)
    return np.array(type(error).__name__ if is_own else repr(error))


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
        mistake = likely_mistake(shown_by, implementation, exercise)
        operation = getattr(stated.check, "operation", None)
        if mistake or operation is None:
            return mistake
        return misplaced_gradient(stated, operation, implementation)

    return diagnose


LESSONS: dict[str, tuple[Exercise, ...]] = {
    number: tuple(with_points(each, ENTRIES[each.name]["points"]) for each in exercises_of(number))
    for number in MAKES
}

EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise for lesson in LESSONS.values() for exercise in lesson
}

CATALOGUE = {**operations.CATALOGUE, **EXERCISES}

ASSIGNMENTS = {number: tuple(task.name for task in tasks) for number, tasks in LESSONS.items()}
"""The names of the exercises of each lesson, by the number of the lesson."""
