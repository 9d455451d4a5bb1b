"""The curves through keys are those of SciPy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline, PchipInterpolator

from numpy_cae.motion.cubic_pieces import hermite, pchip_slopes, spline


def draw_keys(seed, count):
    """Keys 1/30 to 1 s apart with values of which some repeat, and times between them."""
    rng = np.random.default_rng(seed)
    keys = np.cumsum(rng.integers(1, 31, count)) / 30
    values = rng.normal(size=(count, 2, 3)).round(rng.integers(0, 3))
    return keys, values, rng.uniform(keys[0], keys[-1], 20)


@given(seed=st.integers(0, 999), count=st.integers(2, 40))
def test_pchip_is_that_of_scipy(seed, count):
    keys, values, times = draw_keys(seed, count)
    curve = hermite(keys, values, pchip_slopes(keys, values), times)
    np.testing.assert_allclose(curve, PchipInterpolator(keys, values)(times), atol=1e-12)


@given(seed=st.integers(0, 999), count=st.integers(2, 40))
def test_the_slopes_of_pchip_are_those_of_scipy(seed, count):
    keys, values, _ = draw_keys(seed, count)
    expected = PchipInterpolator(keys, values)(keys, 1)
    np.testing.assert_allclose(pchip_slopes(keys, values), expected, atol=1e-10)


@given(seed=st.integers(0, 999), count=st.integers(2, 40))
def test_the_spline_is_that_of_scipy(seed, count):
    keys, values, times = draw_keys(seed, count)
    expected = CubicSpline(keys, values)(times)
    scale = np.abs(expected).max()
    np.testing.assert_allclose(spline(keys, values, times) / scale, expected / scale, atol=1e-8)


@pytest.mark.parametrize("count", [2, 3, 4, 5])
def test_a_curve_goes_through_its_keys(count):
    keys, values, _ = draw_keys(0, count)
    np.testing.assert_allclose(spline(keys, values, keys), values, atol=1e-12)
    slopes = np.zeros_like(values)
    np.testing.assert_allclose(hermite(keys, values, slopes, keys), values, atol=1e-12)
