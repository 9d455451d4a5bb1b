"""Interpolation is exact for lines and cubics."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from numpy_cae.evaluation import interpolate_cubically, interpolate_linearly

T = np.arange(40.0)


@given(st.integers(0, 2**32 - 1))
def test_lines_are_restored_from_any_holes(seed):
    rng = np.random.default_rng(seed)
    x = rng.normal(size=(2, 1, 3)) * T[:, None] + rng.normal(size=(2, 1, 3))
    known = rng.random(x.shape) < 0.3
    known[:, [0, -1]] = True
    np.testing.assert_allclose(interpolate_linearly(np.where(known, x, 0), known), x, atol=1e-9)


def test_ends_are_repeated_and_unknown_features_unchanged():
    x = np.array([[9.0, 5.0], [1.0, 5.0], [2.0, 5.0], [9.0, 5.0]])
    known = np.array([[0, 0], [1, 0], [1, 0], [0, 0]], dtype=bool)
    assert interpolate_linearly(x, known)[:, 0].tolist() == [1, 1, 2, 2]
    assert interpolate_linearly(x, known)[:, 1].tolist() == [5, 5, 5, 5]
    assert x[0, 0] == 9.0


def test_cubics_are_restored_from_their_keys():
    keys = np.arange(0, 40, 9)
    t = T[:, None] / 10
    x = np.stack([1 + t - 2 * t**2 + 0.5 * t**3, t**2], axis=0)
    spline = interpolate_cubically(x, keys)
    np.testing.assert_allclose(spline[:, : keys[-1] + 1], x[:, : keys[-1] + 1], atol=1e-9)
    np.testing.assert_allclose(spline[:, keys[-1] :], np.repeat(x[:, [keys[-1]]], 4, axis=1))
