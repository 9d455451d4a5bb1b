"""Errors of a motion, measures of a body that moves, and of sets of clips (N, F, C) by the distance

    d(a, b) = √ mean_{t,k} (a_{t,k} - b_{t,k})²

over frames and standardised numbers, so that 1 is one standard deviation in each. `baselines` are
what a manifold is compared with, and `tables` has what `train` and `demo` print.
"""

import numpy as np

from numpy_cae.manifold.pca import PCA as PCA
from numpy_cae.motion.angles import ANGLES
from numpy_cae.motion.contacts import foot_sliding as foot_sliding
from numpy_cae.motion.features import POSITIONS, joint_slice

__all__ = [
    "PCA",
    "angle_distance",
    "clip_distances",
    "diversity",
    "foot_sliding",
    "jitter",
    "nearest_distance",
    "nearest_neighbour_accuracy",
    "position_error",
]


def position_error(features: np.ndarray, truth: np.ndarray, joint: str | None = None) -> float:
    """100 · √ mean((q̂ - q)²), centimetres, over the coordinates of all joints or of one.

    The 60 position features are relative to the body's position on the floor and its heading, so
    that drift of the integrated path does not hide errors of the pose.

    Parameters
    ----------
    features, truth : (…, F, 63) arrays of float
        In metres.
    joint : str, optional
        The only joint to count, such as "left_wrist".
    """
    counted = POSITIONS if joint is None else joint_slice(joint)
    gap = (np.asarray(features) - truth)[..., counted]
    return float(100 * np.sqrt(np.mean(np.square(gap, dtype=np.float64))))


def angle_distance(numbers: np.ndarray, truth: np.ndarray) -> float:
    """mean over frames of ‖θ̂ - θ‖, over the 51 angles of a frame, in radians.

    Parameters
    ----------
    numbers, truth : (…, 54) arrays of float
        Not standardised. The root's translation is left out.
    """
    gap = (np.asarray(numbers, dtype=np.float64) - truth)[..., ANGLES]
    return float(np.linalg.norm(gap, axis=-1).mean())


def clip_distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """d between every clip of a and every clip of b.

    Parameters
    ----------
    a, b : (N, F, C), (M, F, C) arrays of float
        Standardised.

    Returns
    -------
    (N, M) array of float64
    """
    from scipy.spatial.distance import cdist  # slow to import, and seldom used

    rows = np.asarray(a, dtype=np.float64).reshape(len(a), -1)
    columns = np.asarray(b, dtype=np.float64).reshape(len(b), -1)
    return cdist(rows, columns) / np.sqrt(rows.shape[1])


def nearest_distance(clips: np.ndarray, references: np.ndarray) -> float:
    """The mean over the clips of the distance to the nearest of the reference clips."""
    return float(clip_distances(clips, references).min(axis=1).mean())


def diversity(clips: np.ndarray) -> float:
    """The mean distance between two different clips of a set; 0 if all are the same."""
    distances = clip_distances(clips, clips)
    return float(distances[np.triu_indices(len(clips), 1)].mean())


def nearest_neighbour_accuracy(real: np.ndarray, samples: np.ndarray) -> float:
    """The share of right classes, 0.5 at best.

    Parameters
    ----------
    real, samples : (N, F, C) arrays of float
        Equally many of both.

    Raises
    ------
    ValueError
        If their numbers differ.
    """
    clips = np.concatenate([real, samples])
    is_real = np.arange(len(clips)) < len(real)
    distances = clip_distances(clips, clips)
    np.fill_diagonal(distances, np.inf)
    return float(np.mean(is_real[distances.argmin(axis=1)] == is_real))


def jitter(positions: np.ndarray, rate: float) -> float:
    """Mean over joints and frames of the acceleration's magnitude, in m/s².

        mean_{t,j} ‖p_{t+1,j} - 2 p_{t,j} + p_{t-1,j}‖ · rate²

    It is to be compared with the truth's, as it is not best at 0: noise that changes from frame to
    frame increases it far more than the position error, and too much smoothing decreases it.
    ValueError for fewer than 3 frames.
    """
    shape = np.shape(positions)
    if len(shape) != 3 or shape[2] != 3 or shape[0] < 3:
        raise ValueError(f"positions have shape {shape}, expected (3 frames or more, joints, 3)")
    acceleration = np.diff(np.asarray(positions, dtype=np.float64), 2, axis=0) * rate**2
    return float(np.linalg.norm(acceleration, axis=-1).mean())
