"""The exercises of lesson 08, using the manifold.

Repair with an unknown mask, filling in, comparing, and the linear map as a baseline.
"""

import numpy as np

from numpy_cae.course.exercises.checks import Recorded, require_same, same_as, states
from numpy_cae.course.exercises.exercise import exercise
from numpy_cae.course.solutions.lesson_08 import (
    G,
    average_precision,
    denoising_weights,
    fill_unknown,
    rescale,
)
from numpy_cae.verify.operations.case import Case, spread
from numpy_cae.verify.operations.property import agrees

WINDOWS = {"batch": (1, 2), "frames": (2, 3, 4, 6), "channels": (1, 2, 3)}


def blurred(x: np.ndarray) -> np.ndarray:
    """A projection that differs from the identity: a mean of each frame and the one before it."""
    return 0.75 * x + 0.25 * np.roll(x, 1, axis=1) + 0.1


def _damaged_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    batch, frames, channels = (case[name] for name in WINDOWS)
    x = spread(rng, (batch, frames, channels))
    for window, channel in np.ndindex(batch, channels):
        lost = rng.permutation(frames)[: rng.integers(1, frames)]
        x[window, lost, channel] = 0.0
    still = np.zeros((batch, frames, case["still"]))
    still[1:, :, :1] = 1.0  # the first of them is still in the first window only
    return {"x": np.concatenate([x, still], axis=2)}


def _moment_arguments(case: Case) -> dict[str, object]:
    """The moments of correlated random inputs z and outputs x."""
    rng = case.rng()
    inputs = case["inputs"]
    independent = rng.standard_normal((2 * inputs + 2, inputs))
    z = independent @ rng.standard_normal((inputs, inputs))
    x = z @ rng.standard_normal((inputs, case["outputs"])) + independent[:, :1]
    return {"second": z.T @ z / len(z), "cross": z.T @ x / len(z), "kept": case["tenths"] / 10}


def _hole_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shape = (case["batch"], case["frames"], case["channels"])
    known = rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
    project = Recorded("lambda x: 0.75 * x + 0.25 * np.roll(x, 1, axis=1) + 0.1", blurred)
    return {"x": spread(rng, shape), "known": known, "project": project}


def _hidden_arguments(case: Case) -> dict[str, object]:
    both = spread(case.rng(), (case["first"] + case["second"], case["units"]), 0.9)
    return {"y_0": both[: case["first"]], "y_1": both[case["first"] :]}


def _ranking_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    alike = np.arange(case["motions"]) < min(case["alike"], case["motions"])
    distances = spread(rng, (case["motions"],)) + 3.0
    return {"distances": distances, "alike": rng.permutation(alike)}


@states("nothing lost", "a window without zeros is not changed", is_form=True)
def _nothing_lost(function, case, x):
    full = spread(case.rng(), x.shape)
    require_same(function(full), full)


@states("known", "known values stay exactly as they are")
def _known_values_stay(function, case, x, known, project):
    require_same(function(x, known, project)[known], x[known], ("a known value",))


@states("nothing there", "the values of x where it is unknown do not matter, NaN included")
def _unknown_values_ignored(function, case, x, known, project):
    number = function(x, known, project)
    with_nan = function(np.where(known, x, np.nan), known, project)
    if not agrees(with_nan, number):  # the function's own results: neither need be right
        raise AssertionError("NaN in place of the unknown values of x changes what it returns")


STILL = "a feature that is zero in every frame does not count"
_still_features = states("still features", STILL, sizes={"still": (1, 2)})(same_as(rescale))
ALL_KEPT = "with kept = 1 they are ordinary least squares"
_without_mask = states("nothing lost", ALL_KEPT, sizes={"tenths": (10,)})(
    same_as(denoising_weights)
)

EXERCISES = (
    exercise(
        rescale,
        _damaged_arguments,
        {**WINDOWS, "still": (0,)},
        _still_features,
        _nothing_lost,
        value="each window is divided by its share of values that are not zero",
    ),
    exercise(
        denoising_weights,
        _moment_arguments,
        {"inputs": (1, 2, 3, 4), "outputs": (1, 2), "tenths": (5, 3, 8)},
        _without_mask,
        value="they solve M A = B, the means over all masks, weighted by probability",
    ),
    exercise(
        fill_unknown,
        _hole_arguments,
        WINDOWS,
        _known_values_stay,
        _unknown_values_ignored,
        value="an unknown value is that of the projection of the window with zeros there",
        given="adam_step decode_layer encode_layer one_cycle stack_loss zero_values",
    ),
    exercise(
        G,
        _hidden_arguments,
        {"first": (1, 2, 3), "second": (1, 2, 3), "units": (1, 2, 3)},
        value="it is equation 4, channel by channel",
    ),
    exercise(
        average_precision,
        _ranking_arguments,
        {"motions": (1, 2, 3, 5, 8), "alike": (1, 2, 3)},
        value="it is the mean of found so far / rank, over the ranks of the motions alike",
    ),
)
