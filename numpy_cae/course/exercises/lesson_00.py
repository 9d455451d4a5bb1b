"""The exercise of lesson 00, two papers in pictures: one operation with its pullback."""

from numpy_cae.course.exercises.checks import drawn
from numpy_cae.course.exercises.exercise import composed_exercise
from numpy_cae.verify.operations.operation import WINDOW


def square(x):
    """y = x², elementwise.   dL/dx = 2 x · dL/dy"""

    def pullback(dy):
        return 2 * x * dy

    return x * x, pullback


EXERCISES = (composed_exercise(square, drawn(x="batch frames channels"), "x", WINDOW),)
