"""jang2018's network in exercises: its value by loops, and random weights and clips."""

import numpy as np

from numpy_cae.course.exercises.lesson_05 import uniform
from numpy_cae.models.sequential_autoencoder import Weights, gru_weights, weight_shapes
from numpy_cae.verify.case import Case
from numpy_cae.verify.operation import definitions

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
