"""Differences of the whole loss catch known mistakes in jang2018's network: each is planted here.

A mistake is one change of the source of `models.sequential_autoencoder`, which is then executed.
"""

import inspect
from types import ModuleType

import numpy as np
import pytest

from numpy_cae.models import sequential_autoencoder
from numpy_cae.training import unit_directions
from numpy_cae.verify import check_gradients

SOURCE = inspect.getsource(sequential_autoencoder)

MISTAKES = {
    "the gradient of the fed-back frames is dropped": (
        "frame_pullbacks[k](d_written[k] + dy_fed)",
        "frame_pullbacks[k](d_written[k])",
        "decoder_w",
    ),
    "the path from state to state is dropped": (
        "step_pullbacks[k](dh + dh_through_frame)",
        "step_pullbacks[k](dh_through_frame)",
        "decoder_u",
    ),
    "the pullback does not reverse": (
        "for t in reversed(range(frames))]",
        "for t in range(frames)]",
        "frame_w",
    ),
    "a weight's gradient is that of the first step only": (
        "total += term",
        "total[...] = term",
        "decoder_u",
    ),
    "the first state's gradient is dropped": (
        "state_pullback(dh)",
        "state_pullback(0 * dh)",
        "state_w",
    ),
    "z has no gradient from the reconstruction": (
        "encode_pullback(dz + prior_pullback(weight))",
        "encode_pullback(prior_pullback(weight))",
        "latent_w",
    ),
    "the regulariser has no gradient": (
        "encode_pullback(dz + prior_pullback(weight))",
        "encode_pullback(dz)",
        "latent_w",
    ),
    "the pullback omits λ": ("prior_pullback(weight)", "prior_pullback()", "encoder_u"),
    "the encoder's gradient enters at the first state": (
        "d_states[:, -1], dw, db",
        "d_states[:, 0], dw, db",
        "encoder_u",
    ),
}


def loss_of(source):
    """The whole loss of the network with this source, as an operation on every weight."""
    module = ModuleType("mutant")
    exec(compile(source, "mutant", "exec"), module.__dict__)
    rng = np.random.default_rng(1)
    model = module.SequentialAutoencoder(2, 3, 2, rng, np.float64)
    start = [rng.normal(scale=0.7, size=weight.shape) for weight in model.weights.values()]
    names = list(model.weights)
    x, prior = rng.normal(size=(3, 4, 2)), rng.normal(size=(3, 2))
    directions = unit_directions(4, 2, rng, np.float64)

    def loss(*arrays):
        model.weights.update(zip(names, arrays, strict=True))
        value, gradients = model.loss_and_gradients(x, prior, directions, 0.5)
        return np.float64(value.total), lambda up: tuple(up * gradients[name] for name in names)

    return loss, start, names


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_caught(mistake):
    right, wrong, weight = MISTAKES[mistake]
    assert SOURCE.count(right) == 1
    loss, start, names = loss_of(SOURCE.replace(right, wrong))
    with pytest.raises(AssertionError, match=f"the gradient for {weight}"):
        check_gradients(loss, *start, names=names, only=[weight])


def test_without_a_mistake_nothing_is_caught():
    loss, start, names = loss_of(SOURCE)
    check_gradients(loss, *start, names=names)
