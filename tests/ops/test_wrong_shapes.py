"""A shape that does not fit is an error that names the argument and both shapes."""

import re

import numpy as np
import pytest

from numpy_cae import ops

ONE_FRAME = np.ones((2, 3))
WINDOWS = np.ones((2, 4, 3))
FILTERS = np.ones((5, 3, 2))
STEP = (np.ones((2, 3)), np.ones((2, 4)))
WEIGHTS = (np.ones((3, 12)), np.ones((4, 12)), np.ones(12), np.ones(12))
UNIT = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])


GRU_STEP = (*STEP, *WEIGHTS)
GRU = (WINDOWS, STEP[1], *WEIGHTS)
SLICED = (ONE_FRAME, ONE_FRAME, UNIT)
CONV = (WINDOWS, FILTERS, np.ones(2))
LINEAR = (WINDOWS, np.ones((3, 2)), np.ones(2))


RANDOM = (WINDOWS, WINDOWS > 0)

EVEN_TAPS = "w has shape (4, 3, 2): the number of taps must be odd, got 4"
NO_WINDOWS = "{} has shape (2, 3), expected (batch, frames, channels)"
ODD_FRAMES = "x has shape (2, 3, 1), expected an even number of frames to pool"
MSE_SHAPES = "x_hat has shape (2, 4, 3), expected (2, 3)"
NO_POINTS = "z has shape (2, 4, 3), expected (points, dimensions)"
WRONG_DIRECTIONS = "directions has shape (2, 2), expected (directions, 3)"
NO_UNIT_ROW = "directions[1] has length {}, expected unit rows"
WRONG_BOUND = "bound is {}, expected a number between 0 and 1, both excluded"

WRONG_ARGUMENTS = [
    ("conv1d", CONV, 0, ONE_FRAME, "x has shape (2, 3), expected (batch, frames, 3)"),
    ("conv1d", CONV, 0, np.ones((2, 4, 5)), "x has shape (2, 4, 5), expected (batch, frames, 3)"),
    ("conv1d", CONV, 1, ONE_FRAME, "w has shape (2, 3), expected (taps, in, out)"),
    ("conv1d", CONV, 2, np.ones(1), "b has shape (1,), expected (2,)"),
    ("conv1d", CONV, 1, np.ones((4, 3, 2)), EVEN_TAPS),
    ("transpose_filters", [FILTERS], 0, np.ones(2), "w has shape (2,), expected (taps, in, out)"),
    ("max_pool", [WINDOWS], 0, ONE_FRAME, NO_WINDOWS.format("x")),
    ("max_pool", [WINDOWS], 0, np.ones((2, 3, 1)), ODD_FRAMES),
    ("unpool_even", [WINDOWS], 0, ONE_FRAME, NO_WINDOWS.format("y")),
    ("unpool_random", RANDOM, 0, ONE_FRAME, NO_WINDOWS.format("y")),
    ("unpool_random", RANDOM, 1, ONE_FRAME > 0, "first has shape (2, 3), expected (2, 4, 3)"),
    ("unpool_random", RANDOM, 1, WINDOWS, "first has dtype float64, expected bool"),
    ("linear", LINEAR, 0, np.ones((2, 5)), "x has shape (2, 5), expected (2, 3)"),
    ("linear", LINEAR, 0, np.float64(1), "x has shape (), expected (3,)"),
    ("linear", LINEAR, 1, np.ones(3), "w has shape (3,), expected (in, out)"),
    ("linear", LINEAR, 2, np.ones(1), "b has shape (1,), expected (2,)"),
    ("gru_step", GRU_STEP, 0, np.ones((1, 3)), "x has shape (1, 3), expected (2, in)"),
    ("gru_step", GRU_STEP, 1, np.ones(4), "h has shape (4,), expected (batch, hidden)"),
    ("gru_step", GRU_STEP, 2, np.ones((4, 12)), "w has shape (4, 12), expected (3, 12)"),
    ("gru_step", GRU_STEP, 3, np.ones((4, 8)), "u has shape (4, 8), expected (4, 12)"),
    ("gru_step", GRU_STEP, 4, np.ones(1), "b has shape (1,), expected (12,)"),
    ("gru_step", GRU_STEP, 5, np.ones(1), "c has shape (1,), expected (12,)"),
    ("gru", GRU, 0, ONE_FRAME, "x has shape (2, 3), expected (batch, frames, in)"),
    ("gru", GRU, 1, np.ones((1, 4)), "h0 has shape (1, 4), expected (2, hidden)"),
    ("gru", GRU, 2, np.ones((4, 12)), "w has shape (4, 12), expected (3, 12)"),
    ("mean_squared_error", [WINDOWS] * 2, 1, ONE_FRAME, MSE_SHAPES),
    ("sliced_wasserstein", SLICED, 0, WINDOWS, NO_POINTS),
    ("sliced_wasserstein", SLICED, 1, np.ones((3, 3)), "prior has shape (3, 3), expected (2, 3)"),
    ("sliced_wasserstein", SLICED, 2, np.ones((2, 2)), WRONG_DIRECTIONS),
    ("sliced_wasserstein", SLICED, 2, UNIT * [[1.0], [1.5]], NO_UNIT_ROW.format(1.5)),
    ("sliced_wasserstein", SLICED, 2, UNIT * [[1.0], [0.5]], NO_UNIT_ROW.format(0.5)),
    ("arctanh", [WINDOWS, 0.9], 1, 0, WRONG_BOUND.format(0)),
    ("arctanh", [WINDOWS, 0.9], 1, 1, WRONG_BOUND.format(1)),
]


@pytest.mark.parametrize(
    ("operation", "arguments", "position", "other", "message"), WRONG_ARGUMENTS
)
def test_an_argument_that_does_not_fit(operation, arguments, position, other, message):
    arguments = [other if i == position else a for i, a in enumerate(arguments)]
    with pytest.raises(ValueError, match="^" + re.escape(message) + "$"):
        getattr(ops, operation)(*arguments)


@pytest.mark.parametrize(
    ("operation", "arguments", "name", "shape"),
    [
        ("conv1d", CONV, "dy", (2, 4, 2)),
        ("transpose_filters", [FILTERS], "dw_tilde", (5, 2, 3)),
        ("max_pool", [WINDOWS], "dy", (2, 2, 3)),
        ("unpool_even", [WINDOWS], "dx", (2, 8, 3)),
        ("unpool_random", [WINDOWS, WINDOWS > 0], "dx", (2, 8, 3)),
        ("tanh", [WINDOWS], "dy", (2, 4, 3)),
        ("sigmoid", [WINDOWS], "dy", (2, 4, 3)),
        ("arctanh", [WINDOWS, 0.9], "dx", (2, 4, 3)),
        ("linear", LINEAR, "dy", (2, 4, 2)),
        ("gru_step", GRU_STEP, "dh_next", (2, 4)),
        ("gru", GRU, "dy", (2, 4, 4)),
    ],
)
def test_an_upstream_gradient_that_does_not_fit(operation, arguments, name, shape):
    _, pullback = getattr(ops, operation)(*arguments)
    message = re.escape(f"{name} has shape (1,), expected {shape}")
    with pytest.raises(ValueError, match=f"^{message}$"):
        pullback(np.ones(1))


def test_directions_in_float32_are_of_unit_length_enough():
    rows = np.random.default_rng(0).standard_normal((50, 8)).astype(np.float32)
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    ops.sliced_wasserstein(np.ones((4, 8), np.float32), np.ones((4, 8), np.float32), rows)
