"""The exercises of the lessons, as data: check cells, the tests and grading all use them."""

from collections.abc import Callable
from dataclasses import replace
from importlib import import_module

from numpy_cae.verify.operations import catalogue as operations
from numpy_cae.verify.operations.catalogue import Exercise
from numpy_cae.verify.operations.property import Property

EASY_POINTS, MEDIUM_POINTS, HARD_POINTS = 10, 20, 40
SHARES = {0: 0.4, 1: 0.4, 2: 0.2}
"""SHARES: the parts of an exercise's points for its value, its gradients and the rest. If an
exercise has no gradients or no rest, the value has their part, too."""
EASY = frozenset(
    "square chain_to_root speeds conv1d_by_loops unfold pooled_again tanh zero_values sgd_step "
    "frames_seen stage_inputs fill_unknown norms_through_time sigmoid clip_gradients unit_rows "
    "adjoint_gap conv1d_unfolded conv1d_shifted".split()
)
HARD = frozenset(
    "forward_kinematics conv1d layer_loss stack_loss gru_step gru self_fed check_gradients "
    "conv1d_by_blocks".split()
)


def with_points(exercise: Exercise) -> Exercise:
    """The exercise with the points of its difficulty: easy, hard, or else medium.

    Properties of one group of `SHARES` have equal points, except that "value" has as many as all
    others of its group together.
    """
    name = exercise.name
    total = EASY_POINTS if name in EASY else HARD_POINTS if name in HARD else MEDIUM_POINTS
    groups = [stated.group for stated in exercise.properties]
    shares = {group: SHARES[group] for group in set(groups)}
    shares[0] += 1 - sum(shares.values())
    weights = [
        max(1, groups.count(0) - 1) if stated.name == "value" else 1
        for stated in exercise.properties
    ]
    of_group = {g: sum(w for w, of in zip(weights, groups, strict=True) if of == g) for g in shares}
    points = (total * shares[g] * w / of_group[g] for w, g in zip(weights, groups, strict=True))
    diagnose = None if name in operations.CATALOGUE else _likely_mistake
    properties = (
        replace(stated, points=number, diagnose=diagnose)
        for stated, number in zip(exercise.properties, points, strict=True)
    )
    return replace(exercise, properties=tuple(properties))


def _likely_mistake(stated: Property, implementation: Callable) -> str:
    return likely_mistake(stated, implementation)


LESSONS: dict[str, tuple[Exercise, ...]] = {
    number: tuple(map(with_points, import_module(f"{__name__}.lesson_{number}").EXERCISES))
    for number in (f"{n:02}" for n in range(15))
}

EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise for lesson in LESSONS.values() for exercise in lesson
}

CATALOGUE = {**operations.CATALOGUE, **EXERCISES}

# Now, since it imports this package; and not later, since a student's process may not import it.
from numpy_cae.course.mistakes import likely_mistake  # noqa: E402

__all__ = ["CATALOGUE", "EXERCISES", "LESSONS", "Exercise"]
