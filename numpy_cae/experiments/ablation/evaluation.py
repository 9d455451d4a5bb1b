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
ACTIVE = 0.1
"""A hidden value above this is counted as active, and a unit whose root mean square is above it."""
MEASURES = {
    "units": ("units active", 0),
    "at_once": ("hidden values active, %", 0),
    "reconstruction": ("reconstruction, cm", 2),
    "half_zeroed": ("half zeroed, cm", 2),
}
"""Heading and digits of each measure. Both errors are of held-out windows; half zeroed: after each
value was lost with probability `P`."""

Measured = dict[str, float]
"""The measures of one method for one seed; nan for one that does not apply."""
NOTHING, LINEAR = "as damaged", "linear denoiser, 15 frames"
PCA_WINDOWS, RESCALED = "PCA on windows", "PCA on windows, X_c / (1 - p)"


class Evaluation:
    """Takes, cut into windows once; ValueError for fewer than two to train on or none to test."""

    def __init__(self, material: Material):
        takes = [take.positions for take in material.training]
        untrained = Schedule(Stage(epochs=0), Stage(epochs=0))
        # For the mean pose, the scale and the mean skeleton; its network is not used.
        self.frame = learn_manifold(takes, untrained, filters=(1,), taps=1, show_progress=False)
        self.split = split_of(self.frame, material)
        self.windows = np.concatenate(
            [self.frame.normalise(cut_windows(self.frame.features(take)[0])[0]) for take in takes]
        )

    def manifold(self, network: ConvAutoencoder, rescaled: bool) -> MotionManifold:
        """The network with the common mean pose and scale."""
        return replace(self.frame, network=network, rescales=rescaled)

    def measure(
        self, repair: Callable[[np.ndarray], np.ndarray], seed: int, y: np.ndarray | None = None
    ) -> Measured:
        """Every measure of a method that repairs normalised windows (N, T, 63).

        The seed chooses the values that are lost; y (N, T / 2^n, D) are the hidden units of the
        test windows, where the method has any.
        """
        truth = self.split.testing
        lost = zero_values(truth.x, P, np.random.default_rng(seed))
        active = {"units": np.nan, "at_once": np.nan}
        if y is not None:
            size = np.sqrt(np.mean(y**2, axis=(0, 1)))
            active["units"] = float(np.sum(size > ACTIVE))
            active["at_once"] = float(100 * np.mean(np.abs(y) > ACTIVE))
        return active | {
            "reconstruction": truth.error(repair(truth.x)),
            "half_zeroed": truth.error(repair(lost)),
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
