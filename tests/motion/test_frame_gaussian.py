"""The Gaussian of the frames: the equations of its docstring, written out."""

import numpy as np

from numpy_cae.motion import frame_gaussian
from numpy_cae.motion.frame_gaussian import RIDGE, condition_frames, predict_from_others


def draw_frames(frames=80, columns=6, seed=0):
    rng = np.random.default_rng(seed)
    return rng.normal(size=(frames, 3)) @ rng.normal(size=(3, columns)) + 1


def covariance_of(x):
    covariance = np.cov(x.T, bias=True)
    return covariance + RIDGE * np.trace(covariance) * np.eye(len(covariance))


def test_each_value_is_predicted_by_regression_on_the_others():
    x = draw_frames()
    predicted = predict_from_others(x)
    covariance = covariance_of(x)
    for column in range(x.shape[1]):
        others = np.delete(np.arange(x.shape[1]), column)
        among_others = covariance[np.ix_(others, others)]
        weights = np.linalg.solve(among_others, covariance[others, column])
        mean = x.mean(axis=0)
        expected = mean[column] + (x - mean)[:, others] @ weights
        np.testing.assert_allclose(predicted[:, column], expected, atol=1e-9)


def test_a_motion_at_rest_is_predicted_by_its_mean():
    x = np.full((20, 4), 2.5)
    np.testing.assert_allclose(predict_from_others(x), x)


def test_frames_are_conditioned_by_the_equation(monkeypatch):
    """One estimate of S; known values enter as they are, unknown ones by their precision."""
    monkeypatch.setattr(frame_gaussian, "ESTIMATES", 1)
    monkeypatch.setattr(frame_gaussian, "KNOWN_VARIANCE", 1e-9)
    x = draw_frames()
    rng = np.random.default_rng(1)
    known = rng.random(x.shape) < 0.6
    variances = rng.uniform(0.01, 0.5, x.shape)
    conditioned = condition_frames(x, known, variances)
    covariance = covariance_of(x)
    mean = x.mean(axis=0)
    for frame in range(len(x)):
        known_count = max(known[frame].sum(), 1)
        shared = max(1.0, (~known[frame]).sum() / known_count)
        noise = np.where(known[frame], 1e-9, shared * variances[frame]) * np.diag(covariance)
        gain = covariance @ np.linalg.inv(covariance + np.diag(noise))
        expected = np.where(known[frame], x[frame], mean + gain @ (x[frame] - mean))
        np.testing.assert_allclose(conditioned[frame], expected, atol=1e-5)


def test_known_frames_are_unchanged():
    x = draw_frames()
    known = np.ones(x.shape, bool)
    np.testing.assert_array_equal(condition_frames(x, known, np.zeros(x.shape)), x)


def test_the_covariance_that_is_left_counts_in_the_second_estimate(monkeypatch):
    x = draw_frames()
    known = np.random.default_rng(1).random(x.shape) < 0.6
    variances = np.full(x.shape, 0.3)
    twice = condition_frames(x, known, variances)
    monkeypatch.setattr(frame_gaussian, "ESTIMATES", 1)
    assert not np.allclose(twice, condition_frames(x, known, variances), atol=1e-6)
