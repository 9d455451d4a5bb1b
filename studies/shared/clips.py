"""The windows of the test takes of a material."""

import numpy as np

from numpy_cae.evaluation.clips import Clips, clips_of
from numpy_cae.manifold import MotionManifold
from studies.shared.material import Material

TESTING_WINDOWS = 120
"""TESTING_WINDOWS: at most this many windows, evenly spaced; more would take minutes and hardly
change the results."""


def testing_of(manifold: MotionManifold, material: Material) -> tuple[Clips, str]:
    """The windows to measure on, and a sentence that describes them."""
    testing = clips_of(manifold, [take.positions for take in material.testing])
    testing = testing.evenly(TESTING_WINDOWS)
    takes = len(np.unique(testing.take))
    return testing, f"Measured on {len(testing)} windows of {takes} takes not used in training."
