"""Hidden numbers predicted from visible ones."""

import numpy as np
from numpy.testing import assert_allclose

from numpy_cae.motion import regression
from numpy_cae.motion.regression import (
    JOIN_SECONDS,
    LAGS_SECONDS,
    LEAST_FRAMES,
    RIDGE,
    fit_ridge,
    join_ends,
    join_lags,
    predict_hidden,
)

HOLE = slice(40, 60)


def example(rate=30.0, frames=120):
    """Visible numbers and hidden ones that are a sum of them, with a hole in the latter."""
    t = np.arange(frames) / rate
    visible = np.stack([np.sin(5 * t), np.cos(3 * t), np.sin(2 * t)], axis=1)
    hidden = visible @ np.array([[1.0, 0.0], [2.0, -1.0], [0.5, 1.0]])
    is_known = np.ones(frames, bool)
    is_known[HOLE] = False
    return visible, hidden, np.ones(frames, bool), is_known


def test_what_is_linear_in_the_visible_numbers_is_predicted():
    visible, hidden, is_visible, is_known = example()
    predicted = predict_hidden(visible, hidden, is_visible, is_known, HOLE, 30.0)
    assert np.abs(predicted - hidden[HOLE]).max() < 0.01 * np.ptp(hidden)


def test_the_values_of_a_hole_are_ignored():
    visible, hidden, is_visible, is_known = example()
    predicted = predict_hidden(visible, hidden, is_visible, is_known, HOLE, 30.0)
    hidden[HOLE] = 1000.0
    again = predict_hidden(visible, hidden, is_visible, is_known, HOLE, 30.0)
    assert_allclose(again, predicted)


def test_the_ridge_solves_the_normal_equations():
    rng = np.random.default_rng(0)
    x = rng.normal(size=(50, 6))
    y = rng.normal(size=(50, 2))
    b = fit_ridge(x, y)
    ridge = RIDGE * np.sum(x**2)
    assert_allclose(x.T @ (y - x @ b), ridge * b, atol=1e-10)


def test_where_nothing_moves_the_prediction_is_constant():
    still = np.zeros((60, 3))
    is_known = np.ones(60, bool)
    is_known[20:30] = False
    hidden = np.full((60, 1), 2.0)
    predicted = predict_hidden(still, hidden, np.ones(60, bool), is_known, slice(20, 30), 30.0)
    assert_allclose(predicted, 2.0)


def test_an_offset_at_the_ends_falls_to_zero_inside_a_long_hole():
    ends = np.array([-2.0, -1.0, 0.0, 121.0, 122.0, 123.0]) / 30
    inside = np.arange(1, 121) / 30
    offset = join_ends(ends, np.ones((6, 1)), inside)[:, 0]
    assert offset[0] > 0.9 and offset[-1] > 0.9
    assert abs(offset[60]) < 1e-3
    assert inside[60] > 5 * JOIN_SECONDS


def test_a_short_hole_continues_the_residual_smoothly():
    times = np.arange(40) / 30
    residual = np.sin(2 * times)[:, None]
    known = np.r_[0:18, 22:40]
    inside = np.arange(18, 22)
    joined = join_ends(times[known], residual[known], times[inside])
    assert_allclose(joined, residual[inside], atol=0.02)


def test_too_few_complete_frames_predict_nothing():
    visible, hidden, is_visible, _ = example()
    is_known = np.zeros(120, bool)
    is_known[: LEAST_FRAMES - 1] = True
    assert predict_hidden(visible, hidden, is_visible, is_known, HOLE, 30.0) is None


def test_the_prediction_is_the_mean_over_the_lags(monkeypatch):
    visible, hidden, is_visible, is_known = example()
    hidden = hidden**2
    arguments = (visible, hidden, is_visible, is_known, HOLE, 30.0)
    together = predict_hidden(*arguments)
    single = []
    for seconds in LAGS_SECONDS:
        monkeypatch.setattr(regression, "LAGS_SECONDS", (seconds,))
        single.append(predict_hidden(*arguments))
    assert_allclose(together, np.mean(single, axis=0))
    assert np.ptp(single, axis=0).max() > 1e-3


def test_a_lag_with_too_few_complete_frames_is_left_out(monkeypatch):
    """In 21 visible frames 17 are complete with the lag of two frames, 13 with that of four."""
    visible, hidden, is_visible, is_known = example()
    is_visible[:5] = is_visible[26:] = False
    arguments = (visible, hidden, is_visible, is_known, HOLE, 30.0)
    predicted = predict_hidden(*arguments)
    monkeypatch.setattr(regression, "LAGS_SECONDS", LAGS_SECONDS[:1])
    assert_allclose(predicted, predict_hidden(*arguments))


def test_frames_next_to_unknown_visible_numbers_are_not_fitted():
    visible, hidden, is_visible, is_known = example()
    expected = predict_hidden(visible, hidden, is_visible, is_known, HOLE, 30.0)
    spoilt = visible.copy()
    spoilt[90] = 1e6
    is_visible[90] = False
    predicted = predict_hidden(spoilt, hidden, is_visible, is_known, HOLE, 30.0)
    assert_allclose(predicted, expected, atol=0.01 * np.ptp(hidden))


def test_lags_repeat_the_first_and_the_last_frame():
    values = np.arange(5.0)[:, None]
    expected = [[0, 0, 2], [0, 1, 3], [0, 2, 4], [1, 3, 4], [2, 4, 4]]
    assert_allclose(join_lags(values, 2), expected)
