"""The windows and measures that are common to all networks and baselines of an ablation."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from numpy_cae.experiments.clips import Split, split_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.repair.repair_sweep import pca_on_windows
from numpy_cae.manifold import MotionManifold, learn_manifold
from numpy_cae.manifold.shifted_projection import zeroed_fraction
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
NOTHING, LINEAR = "as damaged", "linear denoiser, 15 frames"
PCA_WINDOWS, RESCALED = "PCA on windows", "PCA on windows, X_c / (1 - p)"


class Evaluation:
    """Takes, cut into windows once; ValueError for fewer than two to train on or none to test."""

    def __init__(self, material: Material):
        takes = [take.positions for take in material.training]
        untrained = Schedule(Stage(epochs=0), Stage(epochs=0))
        # For the mean pose, the scale and the mean skeleton; its network is not used.
        self.frame = learn_manifold(takes, untrained, filters=(1,), taps=1)
        self.split = split_of(self.frame, material)
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
        truth = self.split.testing
        damaged = zero_values(truth.x, P, np.random.default_rng(seed))
        return {
            RECONSTRUCTION: truth.error(repair(truth.x)),
            HALF_REMOVED: truth.error(repair(damaged)),
        }


def baselines(split: Split) -> dict[str, Callable[[np.ndarray], np.ndarray]]:
    """Functions that repair normalised windows, by name, fitted to the training takes.

    PCA has the size that repairs held-back training takes best; the linear map is the one for the
    share of zeros in each window, to a tenth.
    """
    pca = pca_on_windows(split)
    practice = zero_values(split.choosing.x, P, np.random.default_rng(0))
    plain = pca.best(practice, split.choosing)
    rescaled = pca.best(practice / (1 - P), split.choosing)
    linear = cache(lambda p: split.moments.solve(1 - p))

    def linearly(x: np.ndarray) -> np.ndarray:
        ps = [round(float(p), 1) for p in zeroed_fraction(x)[:, 0, 0]]
        return np.concatenate([linear(p).repair(x[n : n + 1]) for n, p in enumerate(ps)])

    return {
        NOTHING: lambda x: x,
        PCA_WINDOWS: lambda x: pca.repair(x, plain),
        RESCALED: lambda x: pca.repair(x / (1 - zeroed_fraction(x)), rescaled),
        LINEAR: linearly,
    }
