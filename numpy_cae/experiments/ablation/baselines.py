"""The baselines of an ablation: no repair, PCA on windows, the best linear map."""

from collections.abc import Callable
from functools import cache

import numpy as np

from numpy_cae.experiments.ablation.evaluation import P
from numpy_cae.experiments.repair.repair_baselines import pca_on_windows
from numpy_cae.experiments.split import Split
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.training import zero_values

NOTHING, LINEAR = "as damaged", "linear denoiser, 15 frames"
PCA_WINDOWS, RESCALED = "PCA on windows", "PCA on windows, X_c / (1 - p)"


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
