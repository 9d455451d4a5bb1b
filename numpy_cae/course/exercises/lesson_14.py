"""The exercises of lesson 14, beyond the papers: the losses with which three projects begin."""

from collections.abc import Callable

import numpy as np

from numpy_cae.course.exercises.checks import (
    PULLBACK,
    Arguments,
    drawn,
    require_parts,
    require_same,
    states,
)
from numpy_cae.course.exercises.exercise import Exercise, differentiated_exercise
from numpy_cae.course.solutions.lesson_14 import bones_off, observed_error, path_energy
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.operation import Sizes
from numpy_cae.verify.operations.property import Property

TREES = {2: (-1, 0), 3: (-1, 0, 1), 4: (-1, 0, 0, 2)}
RETURNS = ("the loss", PULLBACK)


def _bone_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    q = spread(rng, (case["frames"], case["joints"], 3))
    lengths = rng.uniform(0.2, 0.6, case["joints"])
    return {"q": q, "lengths": lengths, "parents": TREES[case["joints"]]}


def _observed_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["frames"], case["channels"])
    known = rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
    return {"x_hat": spread(rng, shape), "x": rng.permutation(spread(rng, shape)), "known": known}


@states("upstream default", "the upstream gradient is 1 by default", is_form=True)
def _upstream_is_one(function, case, **given):
    _, pullback = require_parts(function(*given.values()), RETURNS)
    require_same(pullback(), pullback(1.0), ("the gradient without an argument",))


@states("unknown is NaN", "an unknown value may be NaN: it adds no loss and gets no gradient")
def _unknown_values(function, case, x_hat, x, known):
    x = np.where(known, x, np.nan)
    loss, pullback = require_parts(function(x_hat, x, known), RETURNS)
    require_same(loss, observed_error(x_hat, x, known)[0], ("the loss",))
    gradient = pullback()
    if np.shape(gradient) == known.shape:  # another shape is what the gradient's property says
        require_same(gradient * ~known, 0 * known, ("the gradient of an unknown value",))


def _loss_exercise(
    solution: Callable, of: str, arguments: Arguments, sizes: Sizes, *special: Property
) -> Exercise:
    """An exercise about the loss of an argument, and the pullback of the loss."""
    return differentiated_exercise(
        solution,
        arguments,
        (of,),
        RETURNS,
        sizes,
        _upstream_is_one,
        *special,
        value="the loss is that of the definition",
        gradients={f"gradient for {of}": ()},
        given="unit_rows zero_values",
    )


BONE_SIZES = {"frames": (1, 2), "joints": (2, 3, 4)}
PATH_SIZES = {"points": (2, 3, 4, 5), "numbers": (1, 2, 3)}
VALUE_SIZES = {"frames": (1, 2, 3), "channels": (1, 2, 3)}

EXERCISES = (
    _loss_exercise(bones_off, "q", _bone_arguments, BONE_SIZES),
    _loss_exercise(path_energy, "path", drawn(path="points numbers"), PATH_SIZES),
    _loss_exercise(observed_error, "x_hat", _observed_arguments, VALUE_SIZES, _unknown_values),
)
