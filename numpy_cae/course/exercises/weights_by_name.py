"""jang2018's network in exercises: weights by name, values loop by loop, what a dict owes."""

from __future__ import annotations

import numpy as np

from numpy_cae.course.exercises.exercise import Claim
from numpy_cae.course.exercises.lesson_05 import scattered
from numpy_cae.models.sequential_autoencoder import Weights, gru_weights, weight_shapes
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case

FLOAT32 = "np.zeros makes float64 unless it is told a dtype, and everything after it follows"
REACH = 0.9


def fed(h, frames, w, u, b, c, frame_w, frame_b):
    """What `self_fed` writes, loop by loop."""
    y, written = np.zeros((len(h), len(frame_b))), []
    for _ in range(frames):
        h = definitions.gru_step(y, h, w, u, b, c)
        y = definitions.linear(h, frame_w, frame_b)
        written.append(y)
    return np.stack(written, axis=1)


def defined_read(weights: Weights, x: np.ndarray) -> np.ndarray:
    """z, loop by loop."""
    nothing = np.zeros((len(x), len(weights["encoder_u"])))
    states = definitions.gru(x, nothing, *gru_weights(weights, "encoder"))
    return definitions.linear(states[:, -1], weights["latent_w"], weights["latent_b"])


def defined_write(weights: Weights, z: np.ndarray, frames: int) -> np.ndarray:
    """x̂, loop by loop."""
    h = definitions.linear(z, weights["state_w"], weights["state_b"])
    frame = [weights[name] for name in ("frame_w", "frame_b")]
    return fed(h, frames, *gru_weights(weights, "decoder"), *frame)[:, ::-1]


def drawn_weights(case: Case, rng: np.random.Generator) -> Weights:
    """Every weight of the network by name."""
    shapes = weight_shapes(case["features"], case["hidden"], case["latent"])
    return {name: scattered(rng, shape, REACH) for name, shape in shapes.items()}


def drawn_clips(case: Case, rng: np.random.Generator) -> np.ndarray:
    """(B, T, F)."""
    return scattered(rng, (case["batch"], case["frames"], case["features"]), 1.0)


def by_name(found, names) -> tuple[np.ndarray, ...]:
    """The gradients of a dict in the order of `names`.

    Raises
    ------
    AssertionError
        If it is none, or one is missing.
    """
    if not isinstance(found, dict):
        raise AssertionError(f"expected a dict of gradients by name, got {type(found).__name__}")
    missing = [name for name in names if name not in found]
    if missing:
        raise AssertionError(f"no gradient for {', '.join(missing)}")
    return tuple(found[name] for name in names)


def two(returned, what: str):
    """Both things that a function returned.

    Raises
    ------
    AssertionError
        If it did not return two.
    """
    if not (isinstance(returned, tuple | list) and len(returned) == 2):
        raise AssertionError(f"it does not return two things: {what}")
    return returned


def keeps_float32(arguments, gradients_of) -> Claim:
    """The claim that float32 in is float32 out, in value and gradients.

    Parameters
    ----------
    arguments : callable
        As the exercise has it; dicts of arrays are narrowed too.
    gradients_of : callable
        What the function returned to its value and a sequence of gradients.
    """

    def check(function, case: Case) -> None:
        value, gradients = gradients_of(function(*map(_narrow, arguments(case).values())))
        for what, array in (("the value", value), *(("a gradient", g) for g in gradients)):
            dtype = np.asarray(array).dtype
            if dtype != np.float32 and type(array) is not float:
                raise AssertionError(f"given float32, {what} is {dtype}")

    return Claim("dtype", "float32 stays float32", check, hint=FLOAT32)


def unaltered_by_name(arguments) -> Claim:
    """The claim that neither an array nor a weight is altered."""

    def check(function, case: Case) -> None:
        given = arguments(case)
        function(*given.values())
        for (name, now), kept in zip(given.items(), arguments(case).values(), strict=True):
            whole = not isinstance(kept, dict)
            named, before = ({name: now}, {name: kept}) if whole else (now, kept)
            for each, array in before.items():
                if not np.array_equal(named[each], array):
                    raise AssertionError(f"the call alters {each}")

    return Claim("purity", "no argument is altered", check)


def _narrow(argument):
    if isinstance(argument, dict):
        return {name: array.astype(np.float32) for name, array in argument.items()}
    return argument.astype(np.float32) if isinstance(argument, np.ndarray) else argument
