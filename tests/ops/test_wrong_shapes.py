"""A shape that does not fit is an error that names the argument and both shapes."""

import re
from pathlib import Path

import numpy as np
import pytest

from numpy_cae import ops

ONE_FRAME = np.ones((2, 3))
WINDOWS = np.ones((2, 4, 3))
FILTERS = np.ones((5, 3, 2))
STEP = (np.ones((2, 3)), np.ones((2, 4)))
WEIGHTS = (np.ones((3, 12)), np.ones((4, 12)), np.ones(12), np.ones(12))
UNIT = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])


CONV = (WINDOWS, FILTERS, np.ones(2))
LINEAR = (WINDOWS, np.ones((3, 2)), np.ones(2))

ARGUMENTS = {
    "conv1d": CONV,
    "linear": LINEAR,
    "gru_step": (*STEP, *WEIGHTS),
    "gru": (WINDOWS, STEP[1], *WEIGHTS),
    "transpose_filters": [FILTERS],
    "unpool_random": (WINDOWS, WINDOWS > 0),
    "mean_squared_error": [WINDOWS] * 2,
    "sliced_wasserstein": (ONE_FRAME, ONE_FRAME, UNIT),
    "arctanh": (WINDOWS, 0.9),
    **dict.fromkeys(("max_pool", "unpool_even", "tanh", "sigmoid"), (WINDOWS,)),
}


def table(name):
    return Path(__file__).with_name(name).read_text().splitlines()


@pytest.mark.parametrize("row", table("wrong_arguments.txt"))
def test_an_argument_that_does_not_fit(row):
    operation, position, other, message = row.split(" | ")
    arguments = list(ARGUMENTS[operation])
    arguments[int(position)] = eval(other)
    with pytest.raises(ValueError, match="^" + re.escape(message) + "$"):
        getattr(ops, operation)(*arguments)


@pytest.mark.parametrize("row", table("wrong_upstream_gradients.txt"))
def test_an_upstream_gradient_that_does_not_fit(row):
    operation, name, shape = row.split(" | ")
    _, pullback = getattr(ops, operation)(*ARGUMENTS[operation])
    message = re.escape(f"{name} has shape (1,), expected {shape}")
    with pytest.raises(ValueError, match=f"^{message}$"):
        pullback(np.ones(1))


def test_directions_in_float32_are_of_unit_length_enough():
    rows = np.random.default_rng(0).standard_normal((50, 8)).astype(np.float32)
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    ops.sliced_wasserstein(np.ones((4, 8), np.float32), np.ones((4, 8), np.float32), rows)
