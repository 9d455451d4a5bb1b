"""What training tells whoever waits for it: names, counts, times, and nothing if so asked."""

import io
from types import SimpleNamespace

import numpy as np
import pytest

from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import Schedule, Stage, layerwise, progress, train_autoencoder
from numpy_cae.training.progress import Progress

SCHEDULE = Schedule(Stage(epochs=2, batch=5), Stage(3, 0.01, batch=5))
WINDOWS = np.random.default_rng(0).normal(scale=0.3, size=(12, 8, 3)).astype(np.float32)


def model():
    return ConvAutoencoder(3, (4, 5), taps=3, rng=np.random.default_rng(0))


@pytest.fixture
def opened(monkeypatch):
    """Every progress that training opens, with what it was told."""
    seen = []

    class Recorded:
        def __init__(self, *arguments):
            self.arguments, self.steps, self.epochs, self.closed = arguments, 0, [], 0
            seen.append(self)

        def step(self):
            self.steps += 1

        def epoch(self, epoch, loss):
            self.epochs.append((epoch, loss))

        def close(self):
            self.closed += 1

    monkeypatch.setattr(layerwise, "Progress", Recorded)
    return seen


def test_each_stage_is_announced_with_its_epochs_and_steps(opened):
    history = train_autoencoder(model(), WINDOWS, SCHEDULE)
    assert [each.arguments for each in opened] == [
        ("layer 1", 2, 3, True),
        ("layer 2", 2, 3, True),
        ("fine tuning", 3, 3, True),
    ]
    for each in opened:
        name, epochs, steps, _ = each.arguments
        assert each.steps == epochs * steps
        assert each.epochs == list(enumerate(history.losses[name]))
        assert each.closed == 1


def test_silence_is_passed_on(opened):
    train_autoencoder(model(), WINDOWS, SCHEDULE, show_progress=False)
    assert [each.arguments[3] for each in opened] == [False] * 3


def test_without_a_generator_the_seed_is_0():
    one, other = model(), model()
    train_autoencoder(one, WINDOWS, SCHEDULE, show_progress=False)
    train_autoencoder(other, WINDOWS, SCHEDULE, np.random.default_rng(0), show_progress=False)
    for a, b in zip(one.layers, other.layers, strict=True):
        np.testing.assert_array_equal(a.w, b.w)


def test_a_model_without_a_generator_is_seeded_with_0():
    for a, b in zip(
        ConvAutoencoder(3, (4,), 3).layers,
        ConvAutoencoder(3, (4,), 3, rng=np.random.default_rng(0)).layers,
        strict=True,
    ):
        np.testing.assert_array_equal(a.w, b.w)


def test_encoding_a_part_at_a_time_is_encoding():
    layer = model().layers[0]
    whole, _ = layer.encode_with_pullback(WINDOWS)
    np.testing.assert_array_equal(layerwise._encoded(layer, WINDOWS, at_once=5), whole)


@pytest.mark.parametrize(
    ("epoch", "said"),
    [
        (0, "layer 1, epoch 1/4: loss 0.12500, 30 s gone, 90 s to go\n"),
        (1, "layer 1, epoch 2/4: loss 0.12500, 30 s gone, 30 s to go\n"),
        (3, "layer 1, epoch 4/4: loss 0.12500, 30 s gone, 0 s to go\n"),
    ],
)
def test_a_line_tells_the_time_that_is_left(monkeypatch, epoch, said):
    class Watched(io.StringIO):
        flushed = 0

        def flush(self):
            self.flushed += 1

    clock, stream = iter([100.0, 130.0]), Watched()
    monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    monkeypatch.setattr(progress.sys, "stderr", stream)
    Progress("layer 1", epochs=4, steps=9, bar=False).epoch(epoch, 0.125)
    assert stream.getvalue() == said
    assert stream.flushed, "a line that waits in a buffer tells no one"


def test_a_bar_counts_steps_and_tells_epoch_and_loss(monkeypatch):
    told = []

    class Bar:
        def __init__(self, **arguments):
            told.append(arguments)

        def update(self):
            told.append("step")

        def set_postfix_str(self, text):
            told.append(text)

        def close(self):
            told.append("closed")

    monkeypatch.setattr(progress, "tqdm", Bar)
    stage = Progress("layer 1", epochs=4, steps=9)
    stage.step()
    stage.epoch(1, 0.125)
    stage.close()
    opening = {"total": 36, "desc": "layer 1", "unit": " steps", "file": progress.sys.stderr}
    assert told == [opening, "step", "epoch 2/4, loss 0.12500", "closed"]


@pytest.mark.parametrize(
    "asked", [{"shown": False}, {"bar": False}, {"epochs": 0}, {"without": "tqdm"}]
)
def test_no_bar(monkeypatch, asked):
    def bar(**arguments):
        raise AssertionError("a bar was opened")

    monkeypatch.setattr(progress, "tqdm", None if "without" in asked else bar)
    asked = {"epochs": 1, **{k: v for k, v in asked.items() if k != "without"}}
    stage = Progress("layer 1", steps=1, **asked)
    stage.step()
    stage.close()


def test_the_loss_of_an_epoch_is_the_mean_over_its_windows(monkeypatch):
    """Batches of 5, 5 and 2: the small one counts for its two windows and no more."""
    losses = iter([1.0, 2.0, 4.0, 3.0, 3.0, 3.0])
    monkeypatch.setattr(layerwise, "_step", lambda *arguments: next(losses))
    network = ConvAutoencoder(3, (4,), taps=3)
    stages = Schedule(Stage(epochs=1, batch=5), Stage(1, batch=5))
    history = train_autoencoder(network, WINDOWS, stages, show_progress=False)
    assert history.losses["layer 1"] == [pytest.approx((5 * 1 + 5 * 2 + 2 * 4) / 12)]
    assert history.losses["fine tuning"] == [pytest.approx(3.0)]


def test_divergence_says_where_at_which_rate_and_what_may_help(monkeypatch):
    losses = iter([1.0, 1.0, 1.0, float("inf")])
    monkeypatch.setattr(layerwise, "_step", lambda *arguments: next(losses))
    with pytest.raises(layerwise.DivergedError) as failure:
        train_autoencoder(model(), WINDOWS, SCHEDULE, show_progress=False)
    said = str(failure.value)
    assert said.startswith("layer 1, epoch 2, windows ")
    assert "the loss is inf at rate 0.45, first in layer 1; there is no checkpoint; " in said
    assert said.endswith(
        "a lower rate or smaller values of the input (--rate, --rms) may keep it finite"
    )
