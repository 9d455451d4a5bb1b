"""The exercises of lesson 10, a manifold in sequences: encoder, decoder and loss."""

from collections.abc import Callable

import numpy as np

from numpy_cae.course.exercises.checks import PULLBACK, drawn, size
from numpy_cae.course.exercises.exercise import composed_exercise, differentiated_exercise
from numpy_cae.course.exercises.lesson_05 import uniform
from numpy_cae.course.solutions.lesson_10 import (
    read_clips,
    reconstruction_loss,
    self_fed,
    write_clips,
)
from numpy_cae.models.sequential_autoencoder import Weights, weight_shapes
from numpy_cae.verify.operations.case import Case

SIZES = {"batch": (1, 2), "frames": (1, 2, 3), "features": (1, 2), "hidden": (1, 2)}
WITH_LATENT = {**SIZES, "latent": (1, 2, 3)}
WHOLE_NETWORK = {**WITH_LATENT, "frames": (1, 2), "hidden": (1,)}  # other exercises try its parts
ENCODER = ("encoder_w", "encoder_u", "encoder_b", "encoder_c", "latent_w", "latent_b")
DECODER_GRU = ("decoder_w", "decoder_u", "decoder_b", "decoder_c")
FRAME = ("frame_w", "frame_b")
DECODER = ("state_w", "state_b", *DECODER_GRU, *FRAME)
LOSS_AND_GRADIENTS = ("the loss", "the gradients by name")
WEIGHT_BOUND = 1.0


def random_weights(case: Case, rng: np.random.Generator) -> Weights:
    """Every weight of the network by name."""
    shapes = weight_shapes(case["features"], case["hidden"], case["latent"])
    return {name: uniform(rng, shape, WEIGHT_BOUND) for name, shape in shapes.items()}


def random_clips(case: Case, rng: np.random.Generator) -> np.ndarray:
    """(B, T, F)."""
    return uniform(rng, (case["batch"], case["frames"], case["features"]), 1.0)


def _self_fed_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shapes = weight_shapes(case["features"], case["hidden"], 1)
    return {
        "h": uniform(rng, (case["batch"], case["hidden"]), 1.0),
        "frames": case["frames"],
        **{name[-1]: uniform(rng, shapes[name], WEIGHT_BOUND) for name in DECODER_GRU},
        **{name: uniform(rng, shapes[name], WEIGHT_BOUND) for name in FRAME},
    }


def _weights_of(names: tuple[str, ...]) -> Callable:
    """An entry of `drawn`: the weights with these names."""

    def entry(case: Case, rng: np.random.Generator) -> Weights:
        weights = random_weights(case, rng)
        return {name: weights[name] for name in names}

    return entry


def random_latent(case: Case, rng: np.random.Generator) -> np.ndarray:
    """(B, latent)."""
    return uniform(rng, (case["batch"], case["latent"]), 1.0)


EXERCISES = (
    differentiated_exercise(
        read_clips,
        drawn(weights=_weights_of(ENCODER), x=random_clips),
        ("weights",),
        ("z", PULLBACK),
        WITH_LATENT,
        value="z is that of the definition",
        gradients={"gradients": ()},
        float32=True,
        given="gru linear",
    ),
    composed_exercise(
        self_fed, _self_fed_arguments, "h w u b c frame_w frame_b", SIZES, given="gru_step linear"
    ),
    differentiated_exercise(
        write_clips,
        drawn(weights=_weights_of(DECODER), z=random_latent, frames=size("frames")),
        ("z", "weights"),
        ("x_hat", PULLBACK),
        WITH_LATENT,
        value="the clips are those of the definition",
        gradients={"gradient for z": ("z",), "gradients for the weights": DECODER},
        float32=True,
        given="linear",
    ),
    differentiated_exercise(
        reconstruction_loss,
        drawn(weights=random_weights, x=random_clips),
        ("weights",),
        LOSS_AND_GRADIENTS,
        WHOLE_NETWORK,
        value="the loss is that of the definition",
        gradients={"gradients of writing": DECODER, "gradients of reading": ENCODER},
        float32=True,
        given="clip_gradients mean_squared_error",
    ),
)
