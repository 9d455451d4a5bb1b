"""Training both networks: what each step uses, that they learn, where they stop, what is said."""

from copy import deepcopy
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from numpy_cae.fast import accelerate, fast_conv_autoencoder
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import (
    DivergedError,
    ProgressPrinter,
    TrainingState,
    layerwise,
    optimisers,
    progress,
    sequential,
)
from numpy_cae.training.divergence import require_finite
from numpy_cae.training.layerwise import train_autoencoder
from numpy_cae.training.schedule import RECIPES, Schedule, SequenceSchedule, Stage, recipe
from numpy_cae.training.sequential import train_sequential

NO_EPOCH = Stage(epochs=0)
MOMENTUM = Stage(epochs=2, rate=0.1, batch=4, rescaled=True, momentum=0.9)
ADAM = Stage(epochs=3, rate=0.001, alpha=0.0, batch=4, optimiser="adam", rate_schedule="one-cycle")
SEQUENCE = SequenceSchedule(epochs=3, steps=5, rate=0.01, batch=6, directions=4)
SCHEDULES = {
    "paper": Schedule(Stage(epochs=2), Stage(epochs=2, rate=0.01, alpha=0.0)),
    "momentum": Schedule(Stage(epochs=1), MOMENTUM),
    "end to end": Schedule(NO_EPOCH, ADAM),
    "sequence": SEQUENCE,
    "sequence by adam": replace(SEQUENCE, optimiser="adam"),
}


def waves(rng, count, frames=16):
    """Clips of a sine at a phase drawn anew, in five features."""
    phases = rng.uniform(0, 2 * np.pi, size=(count, 1, 1))
    time = np.arange(frames)[None, :, None] / 2
    return (0.5 * np.sin(time + phases + [0.0, 1.0, 2.5, 4.0, 5.0])).astype(np.float32)


WINDOWS = waves(np.random.default_rng(1), 12, frames=40)


def new_model(schedule, filters=(16, 24)):
    """The network that a schedule trains."""
    rng = np.random.default_rng(3)
    if isinstance(schedule, Schedule):
        return ConvAutoencoder(5, filters, taps=5, rng=rng)
    return SequentialAutoencoder(5, 12, 2, rng)


def parameters(model):
    return model.parameters if isinstance(model, ConvAutoencoder) else model.weights


def train(schedule, draw=waves, off=0.0, model=None, engine=lambda model: model, report=None):
    """The weights by name, and the losses of each stage."""
    model = model or new_model(schedule)
    rng = np.random.default_rng(0)
    if isinstance(model, ConvAutoencoder):
        windows = WINDOWS if draw is waves else draw(rng, 12)
        state = train_autoencoder(engine(model), windows, schedule, rng, report)
    else:
        model.weights["latent_b"] += off
        state = train_sequential(engine(model), draw, schedule, rng, report)
    return parameters(model), state.losses


@pytest.mark.parametrize("name", SCHEDULES)
def test_both_engines_train_alike(name):
    plain, losses = train(SCHEDULES[name], report=ProgressPrinter())
    fast, fast_losses = train(SCHEDULES[name], engine=accelerate)
    for stage, values in losses.items():
        np.testing.assert_allclose(fast_losses[stage], values, rtol=1e-4)
    for weight, values in plain.items():
        np.testing.assert_allclose(fast[weight], values, atol=2e-4, err_msg=weight)


@pytest.mark.parametrize(("name", "threads"), [("paper", 2), ("momentum", 3)])
def test_runs_on_as_many_threads_are_equal_to_the_bit_others_but_for_rounding(
    monkeypatch, name, threads
):
    monkeypatch.setattr(fast_conv_autoencoder, "MIN_MULTIPLICATIONS", 0)
    engines = [partial(accelerate, threads=count) for count in (threads, threads, 1)]
    first, second, single = (train(SCHEDULES[name], engine=engine)[0] for engine in engines)
    for weight in first:
        np.testing.assert_array_equal(first[weight], second[weight])
        np.testing.assert_allclose(first[weight], single[weight], atol=1e-4)


def test_the_defaults_are_the_papers():
    numbers = {"epochs": 25, "rate": 0.5, "decay": 0.9, "alpha": 0.01, "batch": 1, "zeroed": 0.1}
    unused = {"rescaled": False, "momentum": 0.0, "norm": None}
    layer = Stage(**numbers, **unused, optimiser="sgd", rate_schedule="decay")
    assert Schedule() == RECIPES["paper"] == Schedule(layer, replace(layer, rate=0.01, alpha=0.0))
    with pytest.raises(ValueError, match="expected one of paper, fast, best"):
        recipe("slow")
    best = replace(recipe("fast").fine_tuning, epochs=130, rate=0.0015, norm=0.03)
    assert recipe("best") == Schedule(Stage(epochs=0), best)


def test_every_stage_lowers_its_loss():
    _, losses = train(Schedule(Stage(epochs=4), Stage(epochs=4, rate=0.05, alpha=0.0)))
    assert list(losses) == ["layer 1", "layer 2", "fine tuning"]
    assert all(len(curve) == 4 and curve[-1] < curve[0] for curve in losses.values())


def sequence(**changes):
    numbers = {"epochs": 3, "steps": 40, "batch": 16, "directions": 8, "weight": 0.05}
    return SequenceSchedule(**numbers | {"rate": 1.0, "momentum": 0.0} | changes)


def test_it_learns_to_reconstruct_sequences():
    _, losses = train(sequence(), engine=accelerate)
    errors = losses["reconstruction"]
    assert len(errors) == len(losses["discrepancy"]) == 120
    assert np.mean(errors[-12:]) < np.mean(errors[:12]) / 2
    totals = np.array(errors) + 0.05 * np.array(losses["discrepancy"])
    assert losses["sequences"] == pytest.approx(list(totals.reshape(3, 40).mean(axis=1)))


def test_the_regulariser_brings_the_latents_to_the_prior():
    """They begin three off its centre, and only λ has a reason to bring them there."""
    discrepancy = {}
    for weight in (0.0, 1.0):
        _, losses = train(sequence(weight=weight, epochs=2), off=3.0, engine=accelerate)
        discrepancy[weight] = np.mean(losses["discrepancy"][-20:])
    assert discrepancy[1.0] < discrepancy[0.0] / 2


def test_clips_prior_and_directions_are_drawn_anew_at_every_step(monkeypatch):
    """The discrepancy is measured on fresh draws: no point of the prior is seen twice."""
    calls = []
    original = SequentialAutoencoder.loss_and_gradients

    def record(self, *arguments):
        calls.append(deepcopy(arguments))
        return original(self, *arguments)

    monkeypatch.setattr(SequentialAutoencoder, "loss_and_gradients", record)
    train(sequence(epochs=2, steps=30))
    clips, priors, directions, weights = zip(*calls, strict=True)
    for drawn in (clips, priors, directions):
        assert len({array.tobytes() for array in drawn}) == 60 and drawn[0].dtype == np.float32
    assert set(weights) == {0.05}
    points = np.concatenate(priors)
    assert len(np.unique(points, axis=0)) == len(points) == 60 * 16
    np.testing.assert_allclose(points.mean(0), 0, atol=0.15)
    np.testing.assert_allclose(np.cov(points.T), np.eye(2), atol=0.2)


SIX = {"epochs": 3, "rate": 0.4, "decay": 0.5, "norm": 0.02}
of_both = pytest.mark.parametrize(
    "schedule", [Schedule(NO_EPOCH, Stage(**SIX, batch=6)), sequence(**SIX, steps=2)]
)


@of_both
def test_a_step_is_never_longer_than_the_rate_times_the_bound(monkeypatch, schedule):
    """The gradients of the last update, all of them together, are clipped before they descend."""
    before = []
    after = []

    def clip_norm(gradients, bound):
        before.append(optimisers.clip_norm(gradients, bound))

    def update(self, gradients, rate):
        after.append(np.sqrt(sum(float(np.sum(gradient**2)) for gradient in gradients)))

    for module in (layerwise, sequential):
        monkeypatch.setattr(module, "clip_norm", clip_norm)
    monkeypatch.setattr(optimisers.Sgd, "update", update)
    train(schedule)
    assert max(before) > 0.02  # or there was nothing to clip
    np.testing.assert_allclose(after, np.minimum(before, 0.02), rtol=1e-4)


@of_both
def test_the_rate_decays_by_the_epoch(monkeypatch, schedule):
    rates = []
    monkeypatch.setattr(optimisers.Sgd, "update", lambda self, gradients, rate: rates.append(rate))
    train(schedule)
    assert rates == [0.4, 0.4, 0.2, 0.2, 0.1, 0.1]


def test_each_stage_gets_the_clean_input_and_a_corrupted_copy(monkeypatch):
    """Layer 2 learns from what layer 1 makes of the clean windows, corrupted anew (Vincent)."""
    stages = Schedule(layer=Stage(epochs=3), fine_tuning=Stage(epochs=2, rate=0.01, alpha=0.0))
    model = new_model(stages)
    calls = []
    original = model.loss_and_gradients

    def record(x, corrupted, alpha, first, layer):
        clean = model.layers[0].encode_with_pullback(WINDOWS)[0] if layer else WINDOWS
        clean_windows = {window.tobytes() for window in clean}
        if layer != 0:  # layer 1 is still moving while it trains, those above it are not
            assert all(window.tobytes() in clean_windows for window in x)
        lost = corrupted != x
        assert np.all(corrupted[lost] == 0)
        calls.append((layer, alpha, first is not None, lost.mean()))
        return original(x, corrupted, alpha, first, layer)

    monkeypatch.setattr(model, "loss_and_gradients", record)
    train(stages, model=model)
    of_layers = [(layer, 0.01, True) for layer in (0, 1) for _ in range(36)]
    assert [call[:3] for call in calls] == of_layers + [(None, 0.0, False)] * 24
    assert np.mean([call[3] for call in calls]) == pytest.approx(0.1, abs=0.02)


def test_the_input_of_a_layer_is_encoded_by_the_layers_below_it():
    x = np.resize(WINDOWS, (130, 40, 5))  # more windows than are encoded at a time
    model = new_model(Schedule())
    part = layerwise.Part("layer 2", 1, Stage())
    np.testing.assert_allclose(layerwise.input_of(part, model, x), model.encode(x, 1), atol=1e-6)


def test_an_epoch_shows_every_window_once_in_a_new_order_and_has_their_mean_loss(monkeypatch):
    """Batches of 3, 3, 3 and 1: the small one counts for its window and no more."""
    schedule = Schedule(Stage(epochs=2, batch=3), NO_EPOCH)
    model = new_model(schedule, (4,))
    no_gradients = [[np.zeros_like(array) for array in model.parameters.values()]]
    shown = []

    def number_of_the_step(x, *_):
        shown.append(x[:, 0, 0])
        return float(len(shown)), no_gradients

    monkeypatch.setattr(model, "loss_and_gradients", number_of_the_step)
    windows = np.arange(10, dtype=np.float32)[:, None, None] * np.ones((1, 8, 5), np.float32)
    _, losses = train(schedule, lambda *_: windows, model=model)
    first, second = shown[:4], shown[4:]
    assert [len(batch) for batch in first] == [3, 3, 3, 1]
    assert sorted(np.concatenate(first)) == list(range(10))
    assert list(np.concatenate(first)) != list(np.concatenate(second))
    # The steps lose 1, 2, 3 and 4, then 5, 6, 7 and 8.
    assert losses["layer 1"] == pytest.approx([2.2, 6.2])


def test_a_batch_steps_along_the_mean_of_its_gradients():
    """Two windows in one step move the weights by the mean of what each would do."""
    stage = Stage(epochs=1, rate=0.1, batch=2, alpha=0.0, zeroed=0.0)
    moved = []
    for chosen in ([0], [1], [0, 1]):
        model = new_model(Schedule())
        before = model.layers[0].w.copy()
        train_autoencoder(model, WINDOWS[chosen], Schedule(NO_EPOCH, stage))
        moved.append(model.layers[0].w - before)
    np.testing.assert_allclose(moved[2], (moved[0] + moved[1]) / 2, rtol=1e-4, atol=1e-7)


def test_a_line_has_the_time_that_is_left_and_one_within_an_epoch_comes_rarely(monkeypatch, capsys):
    clock = SimpleNamespace(monotonic=lambda: clock.now, now=100.0)
    monkeypatch.setattr(progress, "time", clock)
    state = TrainingState(name="layer 1", epochs=4, steps=8, seconds={"layer 1": 60.0})
    printer = ProgressPrinter()
    for passed, epoch, step, shown in (
        (30, 1, 4, ""),
        (1, 1, 4, "layer 1, epoch 1.50/4, 60 s elapsed, 100 s left\n"),
        (0, 1, 4, ""),
        (0, 2, 0, "layer 1, epoch 2/4: loss 0.50000, 60 s elapsed, 60 s left\n"),
    ):
        state.losses = {"layer 1": [0.5, 0.25, 0.125][: epoch - 1]}
        state.epoch, state.step = epoch, step
        clock.now += passed
        printer(state)
        assert capsys.readouterr().err == shown


def test_in_a_terminal_a_line_renews_itself_and_vanishes_after_the_stage(monkeypatch, capsys):
    clock = SimpleNamespace(monotonic=lambda: clock.now, now=100.0)
    monkeypatch.setattr("numpy_cae.progress.time", clock)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "62")
    state = TrainingState(name="layer 1", epochs=4, steps=8, seconds={"layer 1": 60.0})
    state.losses = {"layer 1": [0.5, 0.25], progress.HELD_OUT: [3.0, 1.5]}
    printer = ProgressPrinter()
    removed = "\r" + " " * 61 + "\r"
    for passed, epoch, step, shown in (
        (2.01, 3, 4, "\rlayer 1, epoch 3.50/4: loss 0.25000, held-out 1.50 cm, 9 s le"),
        (0.29, 3, 5, ""),
        (0.02, 3, 6, f"{removed}\rlayer 1, epoch 3.75/4: loss 0.25000, held-out 1.50 cm, 4 s le"),
        (0.0, 4, 0, removed),
    ):
        state.epoch, state.step = epoch, step
        clock.now += passed
        printer(state)
        assert capsys.readouterr().err == shown


@pytest.mark.parametrize("schedule", [Schedule(), SEQUENCE])
def test_a_loss_that_is_not_finite_changes_no_weight(schedule):
    with pytest.raises(DivergedError, match=r"epoch 1, step 1: .* is nan.*finite: the input"):
        model = new_model(schedule)
        train(schedule, lambda rng, n: np.full((n, 8, 5), np.nan, np.float32), model=model)
    before = parameters(new_model(schedule))
    for name, array in parameters(model).items():
        np.testing.assert_array_equal(array, before[name])


def test_weights_are_checked_at_the_end_of_an_epoch():
    weights = {"w1": np.ones(2), "b1": np.array([np.inf])}
    state = TrainingState()
    state.begin_stage("layer 1", epochs=1, steps=2)
    require_finite(0.1, weights, WINDOWS, 0.5, state, None)
    state.count_step(0.1, examples=1)
    with pytest.raises(DivergedError, match=r"step 2: .* at rate 0\.5; not finite: b1; there"):
        require_finite(0.1, weights, WINDOWS, 0.5, state, None)
