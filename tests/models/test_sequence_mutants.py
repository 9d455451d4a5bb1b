"""Differences of the whole loss do catch what others got wrong: each mistake made on purpose.

A mistake is one change of text in `models.composed_sequence`, which is then run as it stands.
"""

import inspect
from types import ModuleType

import numpy as np
import pytest

from numpy_cae.models import SequentialAutoencoder, composed_sequence
from numpy_cae.training import unit_directions
from numpy_cae.verify import check_gradients

SOURCE = inspect.getsource(composed_sequence)

MISTAKES = {
    "the gradient of the frames that were fed back is dropped": (
        "frame_backs[k](d_emitted[k] + dy_fed)",
        "frame_backs[k](d_emitted[k])",
        "decoder_w",
    ),
    "the state's own path through time is cut": (
        "step_backs[k](dh + dh_through_frame)",
        "step_backs[k](dh_through_frame)",
        "decoder_u",
    ),
    "the pullback does not reverse": (
        "for t in reversed(range(frames))]",
        "for t in range(frames)]",
        "frame_w",
    ),
    "a weight's gradient is that of one step alone": (
        "total += term",
        "total[...] = term",
        "decoder_u",
    ),
    "the first state's gradient is dropped": ("state_back(dh)", "state_back(0 * dh)", "state_w"),
    "z is taken for a point of the prior's alone": (
        "encode_back(dz + prior_back(weight))",
        "encode_back(prior_back(weight))",
        "latent_w",
    ),
    "the regulariser has no gradient": (
        "encode_back(dz + prior_back(weight))",
        "encode_back(dz)",
        "latent_w",
    ),
    "λ is forgotten on the way back": ("prior_back(weight)", "prior_back()", "encoder_u"),
    "the encoder's gradient enters at the first state": (
        "d_states[:, -1], dw, db",
        "d_states[:, 0], dw, db",
        "encoder_u",
    ),
}


def loss_of(source):
    """The whole loss of `composed_sequence` with this source, as an operation on every weight."""
    module = ModuleType("mutant")
    exec(compile(source, "mutant", "exec"), module.__dict__)
    rng = np.random.default_rng(1)
    model = SequentialAutoencoder(2, 3, 2, rng, np.float64)
    start = [rng.normal(scale=0.7, size=weight.shape) for weight in model.weights.values()]
    names = list(model.weights)
    x, prior = rng.normal(size=(3, 4, 2)), rng.normal(size=(3, 2))
    directions = unit_directions(4, 2, rng, np.float64)

    def loss(*arrays):
        weights = dict(zip(names, arrays, strict=True))
        value, gradients = module.loss_and_gradients(weights, x, prior, directions, 0.5)
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
