"""The exercises of lesson 10, a manifold in sequences: encoder, decoder and loss."""

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.checks import PULLBACK, Differentiated, drawn
from numpy_cae.course.exercises.exercise import differentiated_exercise, operation_exercise
from numpy_cae.course.exercises.lesson_05 import uniform
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.models.sequential_autoencoder import Weights, gru_weights, weight_shapes
from numpy_cae.verify.operations.case import Case
from numpy_cae.verify.operations.operation import Operation, definitions

SIZES = {"batch": (1, 2), "frames": (1, 2, 3), "features": (1, 2), "hidden": (1, 2)}
WITH_LATENT = {**SIZES, "latent": (1, 2, 3)}
WHOLE_NETWORK = {**WITH_LATENT, "frames": (1, 2), "hidden": (1,)}  # other exercises try its parts
ENCODER = ("encoder_w", "encoder_u", "encoder_b", "encoder_c", "latent_w", "latent_b")
DECODER_GRU = ("decoder_w", "decoder_u", "decoder_b", "decoder_c")
FRAME = ("frame_w", "frame_b")
DECODER = ("state_w", "state_b", *DECODER_GRU, *FRAME)
LOSS_AND_GRADIENTS = ("the loss", "the gradients by name")
WEIGHT_BOUND = 0.9


def self_fed_by_loops(h, frames, w, u, b, c, frame_w, frame_b):
    """The frames that the decoder writes."""
    y, written = np.zeros((len(h), len(frame_b))), []
    for _ in range(frames):
        h = definitions.gru_step(y, h, w, u, b, c)
        y = definitions.linear(h, frame_w, frame_b)
        written.append(y)
    return np.stack(written, axis=1)


def read_by_loops(weights: Weights, x: np.ndarray) -> np.ndarray:
    """z of clips."""
    zeros = np.zeros((len(x), len(weights["encoder_u"])))
    states = definitions.gru(x, zeros, *gru_weights(weights, "encoder"))
    return definitions.linear(states[:, -1], weights["latent_w"], weights["latent_b"])


def write_by_loops(weights: Weights, z: np.ndarray, frames: int) -> np.ndarray:
    """Clips of z."""
    h = definitions.linear(z, weights["state_w"], weights["state_b"])
    frame = [weights[name] for name in FRAME]
    return self_fed_by_loops(h, frames, *gru_weights(weights, "decoder"), *frame)[:, ::-1]


def reconstruction_by_loops(weights: Weights, x: np.ndarray) -> float:
    """The mean squared error of the reconstructed clips."""
    x_hat = write_by_loops(weights, read_by_loops(weights, x), x.shape[1])
    return definitions.mean_squared_error(x_hat, x)


def random_weights(case: Case, rng: np.random.Generator) -> Weights:
    """Every weight of the network by name."""
    shapes = weight_shapes(case["features"], case["hidden"], case["latent"])
    return {name: uniform(rng, shape, WEIGHT_BOUND) for name, shape in shapes.items()}


def random_clips(case: Case, rng: np.random.Generator) -> np.ndarray:
    """(B, T, F)."""
    return uniform(rng, (case["batch"], case["frames"], case["features"]), 1.0)


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


EXERCISES = (
    differentiated_exercise(
        read_clips,
        Differentiated(_read_arguments, read_by_loops, ("weights",), ("z", PULLBACK)),
        WITH_LATENT,
        value="z is that of the definition, computed by loops",
        gradients={"gradients": (4,)},
        float32=True,
        given="gru linear",
    ),
    operation_exercise(
        Operation(
            "self_fed",
            SIZES,
            _self_fed_arguments,
            ("h", "w", "u", "b", "c", "frame_w", "frame_b"),
            self_fed_by_loops,
        ),
        self_fed,
        given="gru_step linear",
    ),
    differentiated_exercise(
        write_clips,
        Differentiated(_write_arguments, write_by_loops, ("z", "weights"), ("the clips", PULLBACK)),
        WITH_LATENT,
        value="the clips are those of the definition, computed by loops",
        gradients={"gradient for z": (2, ("z",)), "gradients for the weights": (2, DECODER)},
        float32=True,
        given="linear",
    ),
    differentiated_exercise(
        reconstruction_loss,
        Differentiated(
            drawn(weights=random_weights, x=random_clips),
            reconstruction_by_loops,
            ("weights",),
            LOSS_AND_GRADIENTS,
        ),
        WHOLE_NETWORK,
        value="the loss is that of the definition, computed by loops",
        gradients={"gradients of writing": (2, DECODER), "gradients of reading": (3, ENCODER)},
        float32=True,
        given="clip_gradients mean_squared_error",
    ),
)
