"""The smoothing of the heading agrees with SciPy's."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from numpy_cae.motion.heading import smoothed


@pytest.mark.parametrize("frames", [1, 5, 200])
def test_smoothing_holds_the_ends(frames):
    values = np.random.default_rng(frames).normal(size=(frames, 3))
    expected = gaussian_filter1d(values, 10.0, axis=0, mode="nearest")
    np.testing.assert_allclose(smoothed(values, 10.0), expected, atol=1e-12)
