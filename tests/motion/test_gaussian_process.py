"""Curves by Gaussian processes: those of dense matrices, in time linear in the frames."""

import numpy as np
import pytest
import scipy.linalg

from numpy_cae.motion.gaussian_process import LENGTHS, NOISE, fit_curves, gap_variances, matern


def draw_columns(frames, share, seed=0):
    """Columns (frames, 3) that move slowly to fast, and a mask in which such a share is known."""
    rng = np.random.default_rng(seed)
    x = np.sin(np.arange(frames)[:, None] / [20.0, 6.0, 2.0]) + 0.01 * rng.normal(size=(frames, 3))
    known = rng.random(x.shape) < share
    known[rng.permutation(frames)[:2]] = True
    return x, known


def fit_densely(x, is_known):
    """The curve and the length of one column by matrices of covariances."""
    known_frames = np.flatnonzero(is_known)
    frames = np.arange(len(x))
    mean = x[is_known].mean()
    y = x[is_known] - mean
    least = np.inf
    for candidate in LENGTHS:
        between_known = matern(known_frames[:, None] - known_frames, candidate)
        covariance = between_known + NOISE * np.eye(len(y))
        solution = np.linalg.solve(covariance, y)
        cost = len(y) * np.log(y @ solution) + np.linalg.slogdet(covariance)[1]
        if cost < least:
            least = cost
            length = candidate
            curve = mean + matern(frames[:, None] - known_frames, candidate) @ solution
    return np.where(is_known, x, curve), length


@pytest.mark.parametrize(
    ("share", "tolerance"), [(0.1, 1e-8), (0.3, 1e-9), (0.5, 1e-9), (0.9, 1e-9)]
)
@pytest.mark.parametrize("frames", [12, 120])
def test_curves_are_those_of_a_dense_gaussian_process(frames, share, tolerance):
    """Over wide gaps of slow columns the states are known to fewer digits."""
    x, known = draw_columns(frames, share)
    curves = fit_curves(x, known)
    for column in range(3):
        curve, length = fit_densely(x[:, column], known[:, column])
        if not known[:, column].all():
            assert curves.lengths[column] == length
        np.testing.assert_allclose(curves.values[:, column], curve, rtol=0, atol=tolerance)


def test_known_values_are_unchanged_and_unknown_ones_are_ignored():
    x, known = draw_columns(60, 0.3)
    curves = fit_curves(np.where(known, x, np.nan), known).values
    np.testing.assert_array_equal(curves[known], x[known])
    np.testing.assert_array_equal(curves, fit_curves(x, known).values)


def test_curves_are_float64():
    x, known = draw_columns(30, 0.5)
    assert fit_curves(x.astype(np.float32), known).values.dtype == np.float64


def test_a_column_without_a_known_value_is_zero():
    x, known = draw_columns(30, 0.5)
    known[:, 1] = False
    assert not fit_curves(x, known).values[:, 1].any()


def test_columns_that_are_known_are_unchanged():
    x, known = draw_columns(30, 0.5)
    np.testing.assert_array_equal(fit_curves(x, np.ones_like(known)).values, x)


@pytest.mark.parametrize("frames", [1, 2, 40])
def test_a_column_with_a_single_known_value_is_constant(frames):
    x, known = draw_columns(frames, 0.5)
    known[:, 2] = False
    known[frames // 2, 2] = True
    np.testing.assert_allclose(fit_curves(x, known).values[:, 2], x[frames // 2, 2])


def test_equal_known_values_give_a_constant_curve():
    known = np.arange(20)[:, None] % 3 == 0
    np.testing.assert_allclose(fit_curves(np.full((20, 1), 7.25), known).values, 7.25)


def test_lengths_are_chosen_among_those_given():
    x, known = draw_columns(40, 0.5)
    assert set(fit_curves(x, known, [5.0, 10.0]).lengths) <= {5.0, 10.0}
    assert set(fit_curves(x, known, [7.5]).lengths) == {7.5}


def test_work_is_linear_in_the_frames(monkeypatch):
    """All work on frames is in banded matrices of six rows and three columns a frame."""
    sizes = []

    def count_calls_of(module, name):
        called = getattr(module, name)

        def count(band, *arguments, **options):
            sizes.append(band.shape)
            return called(band, *arguments, **options)

        monkeypatch.setattr(module, name, count)

    count_calls_of(scipy.linalg, "cholesky_banded")
    count_calls_of(scipy.linalg.lapack, "dpbsv")
    counts = []
    for frames in (50, 500):
        sizes.clear()
        fit_curves(*draw_columns(frames, 0.5))
        assert set(sizes) == {(6, 3 * frames)}
        counts.append(len(sizes))
    assert counts[0] == counts[1] == len(LENGTHS) * (1 + 3)


def test_the_variance_in_a_gap_is_that_given_the_values_at_its_ends():
    known = np.zeros((9, 1), bool)
    known[[0, 8]] = True
    ends = np.array([0, 8])
    between_ends = matern(ends[:, None] - ends, 10.0)
    for frame in range(1, 8):
        row = matern(frame - ends, 10.0)
        expected = 1 - row @ np.linalg.solve(between_ends, row)
        variances = gap_variances(known, np.array([10.0]))
        np.testing.assert_allclose(variances[frame, 0], max(expected, NOISE), atol=1e-9)
