"""The exercise of lesson 00, two papers in pictures: one operation with its pullback."""

from numpy_cae.course.exercises.exercise import Exercise, operation_exercise
from numpy_cae.verify.case import Case, spread
from numpy_cae.verify.operation import WINDOW, Operation


def square(x):
    """y = x², elementwise.   dL/dx = 2 x · dL/dy"""

    def pullback(dy):
        return 2 * x * dy

    return x * x, pullback


def _arguments(case: Case) -> dict[str, object]:
    return {"x": spread(case.rng(), (case["batch"], case["frames"], case["channels"]))}


EXERCISES: tuple[Exercise, ...] = (
    operation_exercise(
        Operation("square", WINDOW, _arguments, ("x",), lambda x: x * x),
        square,
    ),
)
