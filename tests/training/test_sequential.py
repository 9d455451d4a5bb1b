"""Training jang2018's network: it learns, draws anew at each step, and bounds its steps."""

import numpy as np
import pytest

from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training import DivergedError, SequenceSchedule, sgd, step, train_sequential


def waves(rng, batch):
    """Clips of 8 frames of a sine at a phase drawn anew."""
    phases = rng.uniform(0, 2 * np.pi, size=(batch, 1, 1))
    lags = np.array([0.0, 1.0, 2.5])
    return np.sin(np.arange(8)[None, :, None] / 2 + phases + lags).astype(np.float32)


def trained(draw=waves, off=0.0, **changes):
    numbers = {"epochs": 3, "steps": 40, "batch": 16, "directions": 8, "weight": 0.05}
    numbers |= {"rate": 1.0, "momentum": 0.0}
    model = SequentialAutoencoder(3, 12, 2, np.random.default_rng(3))
    model.weights["latent_b"] += off
    schedule = SequenceSchedule(**numbers | changes)
    rng = np.random.default_rng(0)
    history = train_sequential(model, draw, schedule, rng)
    return model, history.losses


@pytest.fixture
def seen(monkeypatch):
    """The arguments of every call of `loss_and_gradients`."""
    calls = []
    original = SequentialAutoencoder.loss_and_gradients

    def recorded(self, x, prior, directions, weight):
        calls.append((x.copy(), prior.copy(), directions.copy(), weight))
        return original(self, x, prior, directions, weight)

    monkeypatch.setattr(SequentialAutoencoder, "loss_and_gradients", recorded)
    return calls


def test_it_learns_to_reconstruct():
    _, losses = trained()
    errors = losses["reconstruction"]
    assert len(errors) == len(losses["discrepancy"]) == 120
    assert np.mean(errors[-12:]) < np.mean(errors[:12]) / 2
    totals = np.array(errors) + 0.05 * np.array(losses["discrepancy"])
    assert losses["sequences"] == pytest.approx(list(totals.reshape(3, 40).mean(axis=1)))


def test_clips_prior_and_directions_are_drawn_anew_at_every_step(seen):
    """The discrepancy is measured on fresh draws: no point of the prior is seen twice."""
    trained(epochs=2, steps=30)
    clips, priors, directions, weights = zip(*seen, strict=True)
    for drawn in (clips, priors, directions):
        assert len({each.tobytes() for each in drawn}) == 60
    assert set(weights) == {0.05}
    points = np.concatenate(priors)
    assert len(np.unique(points, axis=0)) == len(points) == 60 * 16
    np.testing.assert_allclose(points.mean(0), 0, atol=0.15)
    np.testing.assert_allclose(np.cov(points.T), np.eye(2), atol=0.2)


def test_the_regulariser_brings_the_latents_to_the_prior():
    """They begin three off its centre, and only λ has a reason to bring them there."""
    free, held = (trained(weight=weight, epochs=2, off=3.0)[1] for weight in (0.0, 1.0))
    assert np.mean(held["discrepancy"][-20:]) < np.mean(free["discrepancy"][-20:]) / 2


def test_postures_are_added_to_whole_clips(seen):
    """The same number in all frames of a clip, another in every clip, with this deviation."""
    trained(epochs=1, posture=2.0, draw=lambda rng, batch: np.ones((batch, 8, 3), np.float32))
    added = np.concatenate([clips for clips, *_ in seen]) - 1
    assert added.dtype == np.float32
    np.testing.assert_array_equal(added, np.broadcast_to(added[:, :1], added.shape))
    assert len(np.unique(added[:, 0, 0])) == len(added)
    np.testing.assert_allclose(added.std(), 2.0, rtol=0.1)


def test_a_step_is_never_longer_than_the_rate_times_the_bound(monkeypatch):
    """The gradients of the last update, all of them together, are clipped before they descend."""
    clipped, used, clip_norm = [], [], step.clip_norm

    def update(self, gradients, rate):
        used.append(np.sqrt(sum(float(np.sum(each**2)) for each in gradients)))

    monkeypatch.setattr(step, "clip_norm", lambda *of: clipped.append(clip_norm(*of)))
    monkeypatch.setattr(sgd.Sgd, "update", update)
    trained(norm=0.05, epochs=1)
    assert max(clipped) > 0.05  # or there was nothing to clip
    np.testing.assert_allclose(used, np.minimum(clipped, 0.05), rtol=1e-4)


def test_the_rate_decays_by_the_epoch(monkeypatch):
    rates = []
    monkeypatch.setattr(sgd.Sgd, "update", lambda self, gradients, rate: rates.append(rate))
    trained(epochs=3, steps=2, rate=0.4, decay=0.5)
    assert rates == [0.4, 0.4, 0.2, 0.2, 0.1, 0.1]


def test_a_loss_that_is_not_finite_stops_with_the_epoch():
    def broken(rng, batch):
        return np.full((batch, 8, 3), np.nan, np.float32)

    with pytest.raises(DivergedError, match=r"epoch 1, step 1: the loss is nan.*finite: the input"):
        trained(draw=broken)
