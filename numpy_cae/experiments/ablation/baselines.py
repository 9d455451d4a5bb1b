"""What stands beside the networks of an ablation: nothing, PCA, the best linear map."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

from numpy_cae.baselines import PCA, Moments
from numpy_cae.experiments.ablation.evaluation import Evaluation, Method, P
from numpy_cae.experiments.comparison.distances import Distance, raw_extremes
from numpy_cae.experiments.repair.repair_baselines import pca_on_frames, pca_on_windows
from numpy_cae.manifold import signature
from numpy_cae.manifold.blind import zeroed_fraction
from numpy_cae.motion import FEATURES, cut_windows
from numpy_cae.motion.windows import LENGTH
from numpy_cae.training import zero_values

BASELINES = "no network"
NOTHING, LINEAR = "doing nothing", "linear denoiser, 15 frames"
PCA_FRAMES, PCA_WINDOWS = "PCA on frames, equal latent size", "PCA on windows"
RESCALED = "PCA on windows, X_c / (1 - p)"

_Repair = Callable[[np.ndarray], np.ndarray]


def baselines(evaluation: Evaluation, latent: int) -> dict[str, Method]:
    """Each fitted to the training takes; of PCA on windows, the size that repairs held-back
    training takes best; of linear maps, that for the share of zeros in a window, to a tenth.

    Parameters
    ----------
    evaluation : Evaluation
    latent : int
        Hidden units of a window, for PCA on frames to have as many numbers.
    """
    split, frame = evaluation.split, evaluation.frame
    size = max(1, latent // LENGTH)
    on_frames, on_windows = pca_on_frames(split), pca_on_windows(split)
    practice = zero_values(split.choosing.x, P, np.random.default_rng(0))
    plain = on_windows.best(practice, split.choosing)
    rescaled = on_windows.best(practice / (1 - P), split.choosing)
    moments = Moments.of(split.training.x, split.training.real)
    linear = cache(lambda p: moments.solve(1 - p))

    poses = PCA.fit(np.concatenate([frame.normalise(x) for x in evaluation.training]))
    whole = PCA.fit(split.training.x.reshape(len(split.training), -1))

    def of_poses(features: np.ndarray) -> np.ndarray:
        return signature((frame.normalise(features) - poses.mean) @ poses.axes[:size].T)[None]

    def of_windows(axes: int) -> Distance:
        def rows(features: np.ndarray) -> np.ndarray:
            windows = frame.normalise(cut_windows(features)[0]).reshape(-1, LENGTH * FEATURES)
            return (windows - whole.mean) @ whole.axes[:axes].T

        return Distance(PCA_WINDOWS, rows)

    def linearly(x: np.ndarray) -> np.ndarray:
        ps = [round(float(p), 1) for p in zeroed_fraction(x)[:, 0, 0]]
        return np.concatenate([linear(p).repair(x[n : n + 1]) for n, p in enumerate(ps)])

    def repairs(project: Callable, setting: object) -> _Repair:
        return lambda x: project(x, setting)

    return {
        NOTHING: evaluation.of_projection(lambda x: x, raw_extremes(frame)),
        PCA_FRAMES: evaluation.of_projection(
            repairs(on_frames.repair, size), Distance(PCA_FRAMES, of_poses)
        ),
        PCA_WINDOWS: evaluation.of_projection(repairs(on_windows.repair, plain), of_windows(plain)),
        RESCALED: evaluation.of_projection(
            lambda x: on_windows.repair(x / (1 - zeroed_fraction(x)), rescaled), of_windows(rescaled)
        ),
        LINEAR: evaluation.of_projection(linearly),
    }
