"""The exercises of lesson 10, a manifold in sequences: encoder, decoder and loss."""

from __future__ import annotations

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.checks import PULLBACK, Differentiated, drawn
from numpy_cae.course.exercises.exercise import (
    Exercise,
    differentiated_exercise,
    operation_exercise,
)
from numpy_cae.course.exercises.lesson_05 import uniform
from numpy_cae.course.exercises.sequence_network import (
    DECODER,
    DECODER_GRU,
    DTYPE_HINT,
    ENCODER,
    FRAME,
    LOSS_AND_GRADIENTS,
    SIZES,
    WEIGHT_BOUND,
    WHOLE_NETWORK,
    WITH_LATENT,
    random_clips,
    random_weights,
    read_by_loops,
    reconstruction_by_loops,
    self_fed_by_loops,
    write_by_loops,
)
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.models.sequential_autoencoder import weight_shapes
from numpy_cae.verify.case import Case
from numpy_cae.verify.operation import Operation

USED_TWICE = "a frame is used twice: it is compared, and it is the input of the next step"
SUMMED = "The same map writes every frame: sum over the steps"


def self_fed(h, frames, w, u, b, c, frame_w, frame_b):
    """The package's decoder without its map from z, whose frames are in reverse order."""
    identity = {"state_w": np.eye(h.shape[1], dtype=h.dtype), "state_b": np.zeros_like(h[0])}
    learned = dict(zip((*DECODER_GRU, *FRAME), (w, u, b, c, frame_w, frame_b), strict=True))
    model = SequentialAutoencoder.from_weights(identity | learned)
    clips, back = model.decode_with_pullback(h, frames)

    def pullback(d_written):
        dh, gradients = back(d_written[:, ::-1])
        return dh, *(gradients[name] for name in learned)

    return clips[:, ::-1], pullback


def read_clips(weights, x):
    """From clips to z, from the package."""
    return SequentialAutoencoder.from_weights(weights).encode_with_pullback(x)


def write_clips(weights, z, frames):
    """From z to clips, from the package."""
    return SequentialAutoencoder.from_weights(weights).decode_with_pullback(z, frames)


def reconstruction_loss(weights, x):
    """The mean squared error of reconstructed clips, and its derivatives, from the package."""
    z, read_back = read_clips(weights, x)
    x_hat, write_back = write_clips(weights, z, x.shape[1])
    loss, error_back = ops.mean_squared_error(x_hat, x)
    dz, of_decoder = write_back(error_back())
    return loss, {**read_back(dz), **of_decoder}


def _self_fed_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    shapes = weight_shapes(case["features"], case["hidden"], 1)
    return {
        "h": uniform(rng, (case["batch"], case["hidden"]), 1.0),
        "frames": case["frames"],
        **{name[-1]: uniform(rng, shapes[name], WEIGHT_BOUND) for name in DECODER_GRU},
        **{name: uniform(rng, shapes[name], WEIGHT_BOUND) for name in FRAME},
    }


def _read_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    weights = random_weights(case, rng)
    return {"weights": {name: weights[name] for name in ENCODER}, "x": random_clips(case, rng)}


def _write_arguments(case: Case) -> dict[str, object]:
    rng = case.rng()
    weights = random_weights(case, rng)
    return {
        "weights": {name: weights[name] for name in DECODER},
        "z": uniform(rng, (case["batch"], case["latent"]), 1.0),
        "frames": case["frames"],
    }


_loss_arguments = drawn(weights=random_weights, x=random_clips)


READ = Differentiated(_read_arguments, read_by_loops, ("weights",), ("z", PULLBACK))
WRITE = Differentiated(_write_arguments, write_by_loops, ("z", "weights"), ("the clips", PULLBACK))
LOSS = Differentiated(_loss_arguments, reconstruction_by_loops, ("weights",), LOSS_AND_GRADIENTS)

EXERCISES: tuple[Exercise, ...] = (
    differentiated_exercise(
        read_clips,
        "run the GRU from a state of zeros, take its state after the last frame, and map it. In "
        "the pullback the states of all other frames get a gradient of zero",
        READ,
        WITH_LATENT,
        value="z is that of the definition, computed by loops",
        gradients={"gradients": (4,)},
        float32=True,
        hints={
            "gradients": "the pullback of gru needs a gradient for the state of every frame: "
            "zeros, and at the last frame the gradient from the map to z",
            "dtype": DTYPE_HINT,
        },
        given=("gru", "linear"),
    ),
    operation_exercise(
        Operation(
            "self_fed",
            SIZES,
            _self_fed_arguments,
            ("h", "w", "u", "b", "c", "frame_w", "frame_b"),
            self_fed_by_loops,
        ),
        "keep both pullbacks of every step. In the pullback, pass two gradients from step k + 1 to "
        "step k: that of its input frame and that of its initial state",
        self_fed,
        hints={
            "value": "the first input frame is zeros; after that the input of each step is the "
            "frame that the step before wrote",
            "gradient for h": "it is the gradient of the state that step 1 returns",
            "gradient for w": USED_TWICE,
            "gradient for frame_w": f"{USED_TWICE}. {SUMMED}",
            "gradient for frame_b": f"{USED_TWICE}. {SUMMED}",
            "independence": "the totals start from zero each time the pullback is called",
        },
        given=("gru_step", "linear"),
    ),
    differentiated_exercise(
        write_clips,
        "map z to a state, call self_fed, reverse the frames. The pullback of reversing is "
        "reversing",
        WRITE,
        WITH_LATENT,
        value="the clips are those of the definition, computed by loops",
        gradients={"gradient for z": (2, ("z",)), "gradients for the weights": (2, DECODER)},
        float32=True,
        hints={
            "value": "the decoder writes the last frame of the clip first",
            "gradient for z": "the upstream gradient is in the order of time, self_fed's is not",
            "dtype": DTYPE_HINT,
        },
        given=("linear",),
    ),
    differentiated_exercise(
        reconstruction_loss,
        "encode, decode, compare; then the three pullbacks in reverse. The two dicts of gradients "
        "have no name in common: {**one, **other} is both",
        LOSS,
        WHOLE_NETWORK,
        value="the loss is that of the definition, computed by loops",
        gradients={"gradients of writing": (2, DECODER), "gradients of reading": (3, ENCODER)},
        float32=True,
        hints={
            "gradients of reading": "the clip is the target too, but a target gets no gradient: "
            "the encoder's gradient comes only through z",
            "dtype": DTYPE_HINT,
        },
        given=("mean_squared_error",),
    ),
)
