"""The exercises of the lessons, as data: check cells, the tests and grading all use them."""

from dataclasses import replace
from importlib import import_module

from numpy_cae.verify.operations import catalogue as operations
from numpy_cae.verify.operations.catalogue import Exercise

EASY_POINTS, MEDIUM_POINTS, HARD_POINTS = 10, 20, 40
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

    Its properties get whole numbers in proportion to the points that they state, at least 1; those
    with the largest remainders are rounded up.
    """
    name = exercise.name
    total = EASY_POINTS if name in EASY else HARD_POINTS if name in HARD else MEDIUM_POINTS
    shares = [total * stated.points / exercise.points for stated in exercise.properties]
    points = [max(1, int(share)) for share in shares]
    by_remainder = sorted(range(len(shares)), key=lambda n: points[n] - shares[n])
    for n in by_remainder[: total - sum(points)]:
        points[n] += 1
    properties = zip(exercise.properties, points, strict=True)
    return replace(exercise, properties=tuple(replace(p, points=n) for p, n in properties))


LESSONS: dict[str, tuple[Exercise, ...]] = {
    number: tuple(map(with_points, import_module(f"{__name__}.lesson_{number}").EXERCISES))
    for number in (f"{n:02}" for n in range(15))
}

EXERCISES: dict[str, Exercise] = {
    exercise.name: exercise for lesson in LESSONS.values() for exercise in lesson
}

CATALOGUE = {**operations.CATALOGUE, **EXERCISES}

__all__ = ["CATALOGUE", "EXERCISES", "LESSONS", "Exercise"]
