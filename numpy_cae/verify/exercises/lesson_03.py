"""The exercises of lesson 03, convolution by hand."""

from __future__ import annotations

from numpy_cae.verify.exercises.exercise import Exercise, operation_exercise

EXERCISES: tuple[Exercise, ...] = (
    operation_exercise(
        "conv1d",
        "pad x once; then y is a sum over taps of shifted windows times w[k]",
        hints={"gradient for x": "frame s of x is read by every y[t] with t + k - K//2 = s"},
    ),
)
