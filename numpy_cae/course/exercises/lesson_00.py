"""The exercise of lesson 00, two papers in pictures: one operation with its pullback."""

from numpy_cae.course.exercises.checks import drawn
from numpy_cae.course.exercises.exercise import composed_exercise, right_function
from numpy_cae.verify.operations.operation import WINDOW

square = right_function("square")
"""y = x², elementwise.   dL/dx = 2 x · dL/dy"""


EXERCISES = (composed_exercise(square, drawn(x="batch frames channels"), "x", WINDOW),)
