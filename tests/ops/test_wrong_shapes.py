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


def with_other(arguments, position, other):
    return [other if i == position else a for i, a in enumerate(arguments)]


GRU_STEP = (*STEP, *WEIGHTS)
GRU = (WINDOWS, STEP[1], *WEIGHTS)
SLICED = (ONE_FRAME, ONE_FRAME, UNIT)
CONV = (WINDOWS, FILTERS, np.ones(2))
LINEAR = (WINDOWS, np.ones((3, 2)), np.ones(2))


@pytest.mark.parametrize(
    ("operation", "arguments", "message"),
    [
        (
            "conv1d",
            with_other(CONV, 0, ONE_FRAME),
            "x has shape (2, 3), expected (batch, frames, 3)",
        ),
        (
            "conv1d",
            with_other(CONV, 0, np.ones((2, 4, 5))),
            "x has shape (2, 4, 5), expected (batch, frames, 3)",
        ),
        ("conv1d", with_other(CONV, 1, ONE_FRAME), "w has shape (2, 3), expected (taps, in, out)"),
        ("conv1d", with_other(CONV, 2, np.ones(1)), "b has shape (1,), expected (2,)"),
        (
            "conv1d",
            with_other(CONV, 1, np.ones((4, 3, 2))),
            "w has shape (4, 3, 2): the number of taps must be odd, got 4",
        ),
        ("transpose_filters", [np.ones(2)], "w has shape (2,), expected (taps, in, out)"),
        ("max_pool", [ONE_FRAME], "x has shape (2, 3), expected (batch, frames, channels)"),
        (
            "max_pool",
            [np.ones((2, 3, 1))],
            "x has shape (2, 3, 1), expected an even number of frames to pool",
        ),
        ("unpool_even", [ONE_FRAME], "y has shape (2, 3), expected (batch, frames, channels)"),
        (
            "unpool_random",
            [ONE_FRAME, ONE_FRAME > 0],
            "y has shape (2, 3), expected (batch, frames, channels)",
        ),
        (
            "unpool_random",
            [WINDOWS, ONE_FRAME > 0],
            "first has shape (2, 3), expected (2, 4, 3)",
        ),
        ("unpool_random", [WINDOWS, WINDOWS], "first has dtype float64, expected bool"),
        ("linear", with_other(LINEAR, 0, np.ones((2, 5))), "x has shape (2, 5), expected (2, 3)"),
        ("linear", with_other(LINEAR, 0, np.float64(1)), "x has shape (), expected (3,)"),
        ("linear", with_other(LINEAR, 1, np.ones(3)), "w has shape (3,), expected (in, out)"),
        ("linear", with_other(LINEAR, 2, np.ones(1)), "b has shape (1,), expected (2,)"),
        (
            "gru_step",
            with_other(GRU_STEP, 0, np.ones((1, 3))),
            "x has shape (1, 3), expected (2, in)",
        ),
        (
            "gru_step",
            with_other(GRU_STEP, 1, np.ones(4)),
            "h has shape (4,), expected (batch, hidden)",
        ),
        (
            "gru_step",
            with_other(GRU_STEP, 2, np.ones((4, 12))),
            "w has shape (4, 12), expected (3, 12)",
        ),
        (
            "gru_step",
            with_other(GRU_STEP, 3, np.ones((4, 8))),
            "u has shape (4, 8), expected (4, 12)",
        ),
        ("gru_step", with_other(GRU_STEP, 4, np.ones(1)), "b has shape (1,), expected (12,)"),
        ("gru_step", with_other(GRU_STEP, 5, np.ones(1)), "c has shape (1,), expected (12,)"),
        ("gru", with_other(GRU, 0, ONE_FRAME), "x has shape (2, 3), expected (batch, frames, in)"),
        ("gru", with_other(GRU, 1, np.ones((1, 4))), "h0 has shape (1, 4), expected (2, hidden)"),
        ("gru", with_other(GRU, 2, np.ones((4, 12))), "w has shape (4, 12), expected (3, 12)"),
        ("gru", with_other(GRU, 3, np.ones((4, 8))), "u has shape (4, 8), expected (4, 12)"),
        ("gru", with_other(GRU, 4, np.ones(1)), "b has shape (1,), expected (12,)"),
        ("gru", with_other(GRU, 5, np.ones(1)), "c has shape (1,), expected (12,)"),
        (
            "mean_squared_error",
            [WINDOWS, ONE_FRAME],
            "x_hat has shape (2, 4, 3), expected (2, 3)",
        ),
        (
            "sliced_wasserstein",
            with_other(SLICED, 0, WINDOWS),
            "z has shape (2, 4, 3), expected (points, dimensions)",
        ),
        (
            "sliced_wasserstein",
            with_other(SLICED, 1, np.ones((3, 3))),
            "prior has shape (3, 3), expected (2, 3)",
        ),
        (
            "sliced_wasserstein",
            with_other(SLICED, 2, np.ones((2, 2))),
            "directions has shape (2, 2), expected (directions, 3)",
        ),
        (
            "sliced_wasserstein",
            with_other(SLICED, 2, UNIT * [[1.0], [1.5]]),
            "directions[1] has length 1.5, expected unit rows",
        ),
        (
            "sliced_wasserstein",
            with_other(SLICED, 2, UNIT * [[1.0], [0.5]]),
            "directions[1] has length 0.5, expected unit rows",
        ),
        ("arctanh", [WINDOWS, 0], "bound is 0, expected a number between 0 and 1, both excluded"),
        ("arctanh", [WINDOWS, 1], "bound is 1, expected a number between 0 and 1, both excluded"),
    ],
)
def test_an_argument_that_does_not_fit(operation, arguments, message):
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
