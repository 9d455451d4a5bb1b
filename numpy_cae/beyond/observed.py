"""Projection that knows what is missing: the motion on the manifold that fits what was observed.

    min_Y   mean over observed entries of (Φ†(Y) - X)²,   from Φ(X) on, staying near

Plain projection takes a missing value for the mean pose, and believes it. Here what is missing
pulls at nothing, and the manifold says what goes with the rest.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from numpy_cae.baselines import PCA, interpolate_linearly
from numpy_cae.beyond import constraints
from numpy_cae.beyond.optimise_latent import descend_to
from numpy_cae.manifold.motion_manifold import MotionManifold

NEAR = 0.1
"""β of `descend_to`, beside squared centimetres."""
STEPS = 100
PRIOR = 0.02
"""Chosen on held-out takes: less is worse in long holes, more is better in short ones alone."""
MOST = 20_000
"""Frames that PCA is fitted to."""


def project_observed(
    manifold: MotionManifold,
    features: np.ndarray,
    known: np.ndarray,
    near: float = NEAR,
    steps: int = STEPS,
    poses: PCA | None = None,
) -> np.ndarray:
    """A motion with holes, filled in from the manifold.

    Holes are first filled with something for Φ to start from, `started`. Where that is more than a
    line, what it says of a hole is worth `PRIOR` of an observation.

    What the motion found misses the observed entries by is interpolated over the holes and taken
    away, so that nothing jumps where a hole begins or ends.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        What stands where nothing is known does not matter.
    known : (F, 63) array of bool
    near : float
        How much the start is worth.
    steps : int
        Of the descent, at most.
    poses : PCA, optional
        Of real motion, `poses_of`.

    Returns
    -------
    (F, 63) array of float64
        The known entries as they were, to the bit.

    Raises
    ------
    ValueError
        If `known` does not fit or nothing is known.
    """
    if np.shape(known) != features.shape:
        raise ValueError(f"known has shape {np.shape(known)}, expected {features.shape}")
    if not known.any():
        raise ValueError("nothing is known of the motion")
    start, told = started(manifold, features, known, poses)
    # Every kind of features in the measure of positions: what the network takes for equal.
    weights = np.where(known, 1.0, PRIOR * told) * (manifold.scale / manifold.scale[0]) ** 2

    def wish(x: np.ndarray) -> tuple[float, np.ndarray]:
        loss, pullback = constraints.unlike(x, start, weights)
        return constraints.CENTIMETRES * loss, pullback(constraints.CENTIMETRES)

    units = manifold.encode(start)
    found = manifold.decode(
        descend_to(manifold, units, len(features), wish, near, steps), len(features)
    )
    missed = np.where(known, features - found, 0.0)
    return np.where(known, features, found + interpolate_linearly(missed, known))


def poses_of(manifold: MotionManifold, takes: Sequence[np.ndarray]) -> PCA:
    """PCA of the normalised frames of takes' features (F, 63)."""
    frames = np.concatenate([manifold.normalise(take) for take in takes]).astype(np.float64)
    return PCA.fit(frames[:: -(-len(frames) // MOST)])


def started(
    manifold: MotionManifold, features: np.ndarray, known: np.ndarray, poses: PCA | None = None
) -> tuple[np.ndarray, bool]:
    """A motion with its holes filled without a network, and whether by more than a line.

        x̂ = p + line(x - p)

    p is what PCA makes of those numbers of a pose that are known throughout; line() joins the known
    frames. Without such numbers, or without PCA, p is constant and x̂ a line.
    """
    features = np.where(known, features, manifold.mean_pose)
    throughout = known.all(axis=0)
    if poses is None or not throughout.any() or throughout.all():
        return interpolate_linearly(features, known), False
    rows = manifold.normalise(features).astype(np.float64)
    seen = np.broadcast_to(throughout, known.shape)
    told = manifold.denormalise(poses.fill(rows, seen, len(poses.axes)))
    return told + interpolate_linearly(np.where(known, features - told, 0.0), known), True
