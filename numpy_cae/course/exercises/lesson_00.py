"""The exercise of lesson 00, two papers in pictures: one operation with its pullback."""

from numpy_cae.course.exercises.checks import drawn
from numpy_cae.course.exercises.exercise import composed_exercise
from numpy_cae.course.solutions.lesson_00 import square
from numpy_cae.verify.operations.operation import WINDOW

EXERCISES = (composed_exercise(square, drawn(x="batch frames channels"), "x", WINDOW),)
