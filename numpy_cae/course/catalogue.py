"""The catalogue of the course: every exercise with its points and its known mistakes.

Check cells, the tests and grading all use it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module

from numpy_cae.course.exercises.lesson_12 import VERDICTS
from numpy_cae.course.mistakes import likely_mistake
from numpy_cae.verify.operations import catalogue as operations
from numpy_cae.verify.operations.catalogue import Exercise
from numpy_cae.verify.operations.diagnosis import misplaced_gradient
from numpy_cae.verify.operations.property import Property

EXERCISES_IN = "numpy_cae.course.exercises"
NUMBERS = "00 01 02 03 04 05 06 07 07b 08 09 10 11 12 13 14".split()
SHOWN_BY = {VERDICTS.operation: VERDICTS}
"""SHOWN_BY: what shows which mistake an exercise has, where a property that fails does not."""
SHARES = {0: 0.4, 1: 0.4, 2: 0.2}
"""SHARES: the parts of an exercise's points for its value, its gradients and the rest. If an
exercise has no gradients or no rest, the value has their part, too."""
TRIVIAL = frozenset("sgd_step unit_rows conv1d_unfolded conv1d_shifted".split())
EASY = frozenset(
    "square chain_to_root speeds conv1d_by_loops unfold pooled_again tanh mean_squared_error "
    "mean_absolute zero_values frames_seen stage_inputs momentum_step one_cycle fill_unknown "
    "norms_through_time sigmoid clip_gradients adjoint_gap gate_gradients".split()
)
HARD = frozenset(
    "forward_kinematics conv1d layer_loss stack_loss gru_step gru self_fed check_gradients "
    "conv1d_by_blocks".split()
)
POINTS = dict.fromkeys(TRIVIAL, 5) | dict.fromkeys(EASY, 10) | dict.fromkeys(HARD, 40)
"""POINTS: what an exercise earns; those that are not listed are of medium difficulty."""
MEDIUM_POINTS = 20


def with_points(exercise: Exercise) -> Exercise:
    """The exercise with the points of its difficulty.

    Properties of one group of `SHARES` have equal points, except that "value" has as many as all
    others of its group together.
    """
    name = exercise.name
    total = POINTS.get(name, MEDIUM_POINTS)
    groups = [stated.group for stated in exercise.properties]
    shares = {group: SHARES[group] for group in set(groups)}
    shares[0] += 1 - sum(shares.values())
    weights = [
        max(1, groups.count(0) - 1) if stated.name == "value" else 1
        for stated in exercise.properties
    ]
    of_group = {g: sum(w for w, of in zip(weights, groups, strict=True) if of == g) for g in shares}
    points = (total * shares[g] * w / of_group[g] for w, g in zip(weights, groups, strict=True))
    diagnose = None if name in operations.CATALOGUE else diagnosis(exercise)
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
    number: tuple(map(with_points, import_module(f"{EXERCISES_IN}.lesson_{number}").EXERCISES))
    for number in NUMBERS
}

EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise for lesson in LESSONS.values() for exercise in lesson
}

CATALOGUE = {**operations.CATALOGUE, **EXERCISES}

ASSIGNMENTS = {number: tuple(task.name for task in tasks) for number, tasks in LESSONS.items()}
"""The names of the exercises of each lesson, by the number of the lesson."""
