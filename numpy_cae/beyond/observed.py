"""Projection with known holes: the motion on the manifold that fits the observed values.

    min_Y   mean over observed entries of (Φ†(Y) - X)²,   near Φ(X)

Plain projection takes a missing value for the mean pose; here it has no part in the loss.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from numpy_cae.baselines import PCA, interpolate_linearly
from numpy_cae.beyond import constraints
from numpy_cae.beyond.optimise_latent import optimise_latent
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import joint_slice

BETA = 0.1  # of `optimise_latent`, beside squared centimetres
MAX_STEPS = 100
PCA_WEIGHT = 0.02
"""Weight of a value estimated by PCA, that of an observed value being 1. Chosen on held-out takes:
a smaller one is worse in long holes, a larger one better in short holes only."""
MAX_PCA_FRAMES = 20_000


def fill_observed(
    manifold: MotionManifold, features: np.ndarray, joint: str, poses: PCA | None = None
) -> np.ndarray:
    """As `numpy_cae.manifold.fill_joint`, but by `project_observed`."""
    known = ~np.isnan(features)
    if known.all():
        known[:, joint_slice(joint)] = False
    return project_observed(manifold, features, known, poses=poses)


def project_observed(
    manifold: MotionManifold,
    features: np.ndarray,
    known: np.ndarray,
    beta: float = BETA,
    steps: int = MAX_STEPS,
    poses: PCA | None = None,
) -> np.ndarray:
    """Fill in the holes of a motion from the manifold.

    The optimisation starts from `initial_fill`. The difference between the result and the observed
    values is interpolated linearly over the holes and subtracted, so that there is no jump at the
    edges of a hole.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        Unknown values are ignored.
    known : (F, 63) array of bool
    beta : float
        Weight of the distance from the initial hidden units.
    steps : int
        Largest number of iterations.
    poses : PCA, optional
        Of real motion, by `pose_pca`.

    Returns
    -------
    (F, 63) array of float64
        The known values are the same to the bit.

    Raises
    ------
    ValueError
        If `known` has another shape or nothing is known.
    """
    if np.shape(known) != features.shape:
        raise ValueError(f"known has shape {np.shape(known)}, expected {features.shape}")
    if not known.any():
        raise ValueError("nothing is known of the motion")
    start, by_pca = initial_fill(manifold, features, known, poses)
    # All kinds of features in the unit of positions, as the network weighs them.
    weights = np.where(known, 1.0, PCA_WEIGHT * by_pca) * (manifold.scale / manifold.scale[0]) ** 2

    def objective(x: np.ndarray) -> tuple[float, np.ndarray]:
        loss, pullback = constraints.squared_difference(x, start, weights)
        return constraints.CENTIMETRES * loss, pullback(constraints.CENTIMETRES)

    units = manifold.encode(start)
    units = optimise_latent(manifold, units, len(features), objective, beta, steps)
    found = manifold.decode(units, len(features))
    errors = np.where(known, features - found, 0.0)
    return np.where(known, features, found + interpolate_linearly(errors, known))


def pose_pca(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> PCA:
    """PCA of the normalised frames of takes' features (F, 63)."""
    frames = np.concatenate([manifold.normalise(take) for take in takes]).astype(np.float64)
    return PCA.fit(frames[:: -(-len(frames) // MAX_PCA_FRAMES)])


def initial_fill(
    manifold: MotionManifold, features: np.ndarray, known: np.ndarray, poses: PCA | None = None
) -> tuple[np.ndarray, bool]:
    """The motion with its holes filled in without a network, and whether PCA was used.

        x̂ = p + line(x - p)

    p is the estimate by PCA from the features that are known in all frames, and line() is linear
    interpolation of known values. Without such features, or without PCA, p is constant.
    """
    features = np.where(known, features, manifold.mean_pose)
    always_known = known.all(axis=0)
    if poses is None or not always_known.any() or always_known.all():
        return interpolate_linearly(features, known), False
    rows = manifold.normalise(features).astype(np.float64)
    used = np.broadcast_to(always_known, known.shape)
    estimate = manifold.denormalise(poses.fill(rows, used, len(poses.axes)))
    differences = np.where(known, features - estimate, 0.0)
    return estimate + interpolate_linearly(differences, known), True
