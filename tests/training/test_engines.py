"""The definitions (`ops`) and the fast engine train alike, on any number of threads."""

from functools import partial

import numpy as np
import pytest

from numpy_cae.fast import accelerate, fast_conv_autoencoder
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import (
    Schedule,
    SequenceSchedule,
    Stage,
    train_autoencoder,
    train_sequential,
)

WINDOWS = (0.25 * np.random.default_rng(1).normal(size=(12, 40, 9))).astype(np.float32)
STAGES = {
    "paper": Schedule(Stage(epochs=2), Stage(epochs=2, rate=0.01, alpha=0.0)),
    "momentum": Schedule(
        Stage(epochs=1), Stage(epochs=2, rate=0.1, batch=4, rescaled=True, momentum=0.9)
    ),
    "end to end": Schedule(
        Stage(epochs=0),
        Stage(
            epochs=3, rate=0.001, alpha=0.0, batch=4, optimiser="adam", rate_schedule="one-cycle"
        ),
    ),
}


def trained(schedule, engine):
    model = ConvAutoencoder(9, (16, 24), taps=5, rng=np.random.default_rng(0))
    rng = np.random.default_rng(2)
    history = train_autoencoder(engine(model), WINDOWS, schedule, rng)
    return [array for layer in model.layers for array in (layer.w, layer.b)], history.losses


@pytest.mark.parametrize("name", STAGES)
def test_both_engines_train_the_convolutional_model_alike(name):
    ours, losses = trained(STAGES[name], lambda model: model)
    fast, fast_losses = trained(STAGES[name], accelerate)
    for stage, values in losses.items():
        np.testing.assert_allclose(fast_losses[stage], values, rtol=1e-4)
    for one, other in zip(ours, fast, strict=True):
        np.testing.assert_allclose(other, one, atol=2e-4)


@pytest.mark.parametrize("optimiser", ["sgd", "adam"])
def test_both_engines_train_the_sequential_model_alike(optimiser):
    schedule = SequenceSchedule(
        epochs=3, steps=5, rate=0.01, batch=6, directions=4, optimiser=optimiser
    )

    def draw(rng, batch):
        return rng.normal(size=(batch, 6, 3)).astype(np.float32)

    models = [SequentialAutoencoder(3, 7, 2, np.random.default_rng(0)) for _ in range(2)]
    for model, engine in zip(models, (lambda model: model, accelerate), strict=True):
        train_sequential(engine(model), draw, schedule, np.random.default_rng(1))
    for name, weight in models[0].weights.items():
        np.testing.assert_allclose(models[1].weights[name], weight, atol=2e-4, err_msg=name)


@pytest.mark.parametrize(("name", "threads"), [("paper", 2), ("momentum", 3)])
def test_runs_on_as_many_threads_are_equal_to_the_bit_others_but_for_rounding(
    monkeypatch, name, threads
):
    monkeypatch.setattr(fast_conv_autoencoder, "MIN_MULTIPLICATIONS", 0)
    runs = [partial(accelerate, threads=count) for count in (threads, threads, 1)]
    one, two, single = (trained(STAGES[name], engine)[0] for engine in runs)
    for a, b, c in zip(one, two, single, strict=True):
        np.testing.assert_array_equal(a, b)
        np.testing.assert_allclose(a, c, atol=1e-4)
