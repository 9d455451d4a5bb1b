"""The exercises of lesson 07b, better steps: momentum, Adam, and a rate that rises and falls."""

import numpy as np

from numpy_cae.course.exercises.checks import drawn, require_parts, require_same, size, states
from numpy_cae.course.exercises.exercise import exercise
from numpy_cae.course.solutions.lesson_07b import adam_step, momentum_step, one_cycle
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import require_equal

SHAPE = "taps channels"
SIZES = {"taps": (1, 3), "channels": (1, 2)}
RATE = 0.5
PEAK = 0.8
OF_ADAM = ("the parameter", "the mean", "the square")


def _squares(case: Case, rng: np.random.Generator) -> np.ndarray:
    return spread(rng, (case["taps"], case["channels"])) ** 2


def _share(case: Case, rng: np.random.Generator) -> float:
    return case["hundredths"] / 100


@states("no momentum", "with momentum 0 it is the plain step", is_form=True)
def _plain_step(function, case, parameter, velocity, gradient, rate, momentum):
    returned = function(parameter, velocity, gradient, rate, 0.0)
    moved, _ = require_parts(returned, ("the parameter", "the velocity"))
    require_same(moved, parameter - rate * gradient, ("the parameter",))


@states("first step", "the first step is as long as the rate, whatever the gradient's size")
def _first_step(function, case, parameter, mean, square, gradient, rate, step):
    for factor in (1.0, 1e3):
        zero = np.zeros_like(parameter)
        returned = function(parameter, zero, zero, factor * gradient, rate, 1)
        moved, *_ = require_parts(returned, OF_ADAM)
        what = f"for {factor:g} times the gradient, the size of a first step"
        require_equal(what, np.abs(moved - parameter), np.full(parameter.shape, rate), 1e-6)


@states("cycle", "it begins at peak / 25, has the peak after 30% and ends at 0", is_form=True)
def _three_places(function, case, peak, share):
    for at, part in ((0.0, 0.04), (0.3, 1.0), (1.0, 0.0)):
        require_equal(f"the rate after {at:.0%}", function(peak, at), part * peak)


EXERCISES = (
    exercise(
        momentum_step,
        drawn(parameter=SHAPE, velocity=SHAPE, gradient=SHAPE, rate=RATE, momentum=0.75),
        SIZES,
        _plain_step,
        value="v becomes μ v - η · dL/dθ, and θ becomes θ + v",
        given="sgd_step",
    ),
    exercise(
        adam_step,
        drawn(
            parameter=SHAPE,
            mean=SHAPE,
            square=_squares,
            gradient=SHAPE,
            rate=RATE,
            step=size("step"),
        ),
        {**SIZES, "step": (1, 2, 5, 100)},
        _first_step,
        value="the three results are those of the definition",
    ),
    exercise(
        one_cycle,
        drawn(peak=PEAK, share=_share),
        {"hundredths": (0, 10, 29, 30, 65, 99, 100)},
        _three_places,
        value="half a cosine up to the peak, then half a cosine down",
        pure=False,
        given="encode_layer decode_layer stack_loss zero_values",
    ),
)
