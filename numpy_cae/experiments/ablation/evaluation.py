"""The windows and measures that are common to all networks of an ablation."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from numpy_cae.experiments.clips import testing_of
from numpy_cae.experiments.material import Material
from numpy_cae.manifold import MotionManifold, learn_manifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import cut_windows
from numpy_cae.training import Schedule, Stage, zero_values

P = 0.5
"""The probability with which a value of a test window is removed."""
RECONSTRUCTION, HALF_REMOVED = "reconstruction, cm", "half of the values removed, cm"
"""The two measures of a method, both errors of test windows: undamaged, and after each value was
removed with probability `P`."""
Measured = dict[str, float]
"""The measures of one method for one seed."""


class Evaluation:
    """Takes, cut into windows once; ValueError for none to train on or none to test."""

    def __init__(self, material: Material):
        takes = [take.positions for take in material.training]
        untrained = Schedule(Stage(epochs=0), Stage(epochs=0))
        # For the mean pose, the scale and the mean skeleton; its network is not used.
        self.frame = learn_manifold(takes, untrained, filters=(1,), taps=1)
        self.testing, self.sample = testing_of(self.frame, material)
        self.windows = np.concatenate(
            [self.frame.normalise(cut_windows(self.frame.features(take)[0])[0]) for take in takes]
        )

    def manifold(self, network: ConvAutoencoder, rescaled: bool) -> MotionManifold:
        """The network with the common mean pose and scale."""
        return replace(self.frame, network=network, rescales=rescaled)

    def measure(self, repair: Callable[[np.ndarray], np.ndarray], seed: int) -> Measured:
        """Both measures of a method that repairs normalised windows (N, T, 63).

        The seed chooses the values that are removed.
        """
        truth = self.testing
        damaged = zero_values(truth.x, P, np.random.default_rng(seed))
        return {
            RECONSTRUCTION: truth.error(repair(truth.x)),
            HALF_REMOVED: truth.error(repair(damaged)),
        }
