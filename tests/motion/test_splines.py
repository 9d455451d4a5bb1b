"""Curves and smoothing agree with SciPy's."""

import numpy as np
import pytest
from scipy.interpolate import Akima1DInterpolator, PchipInterpolator
from scipy.ndimage import gaussian_filter1d

from numpy_cae.motion.heading import smoothed
from numpy_cae.motion.splines import akima_slopes, hermite, monotone_slopes


@pytest.mark.parametrize("count", [2, 3, 4, 30])
@pytest.mark.parametrize("rest", [0.0, 0.4])
def test_curves_through_points_some_of_them_at_rest(count, rest):
    rng = np.random.default_rng(count)
    times = np.cumsum(rng.integers(1, 5, count))
    values = np.where(rng.random((count, 20)) < rest, 0.0, rng.normal(size=(count, 20)))
    at = np.linspace(times[0], times[-1], 50)
    found = hermite(times, values, monotone_slopes(times, values), at)
    np.testing.assert_allclose(found, PchipInterpolator(times, values)(at), atol=1e-12)
    if count > 2:
        expected = Akima1DInterpolator(times, values, method="makima", extrapolate=True)
        at = np.append(at, times[-1] + 0.5)
        found = hermite(times, values, akima_slopes(times, values), at)
        np.testing.assert_allclose(found, expected(at), atol=1e-11)


@pytest.mark.parametrize("frames", [1, 5, 200])
def test_smoothing_holds_the_ends(frames):
    values = np.random.default_rng(frames).normal(size=(frames, 3))
    expected = gaussian_filter1d(values, 10.0, axis=0, mode="nearest")
    np.testing.assert_allclose(smoothed(values, 10.0), expected, atol=1e-12)
