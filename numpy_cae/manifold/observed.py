"""Projection that knows what is missing: the motion on the manifold that fits what was observed.

    min_Y   mean over observed entries of (Φ†(Y) - X)²,   from Φ(X) on, staying near

Plain projection takes a missing value for the mean pose, and believes it. Here what is missing
pulls at nothing, and the manifold says what goes with the rest.
"""

from __future__ import annotations

import numpy as np

from numpy_cae.baselines import interpolate_linearly
from numpy_cae.manifold import constraints
from numpy_cae.manifold.descent import descend_to
from numpy_cae.manifold.motion_manifold import MotionManifold

NEAR = 0.1
"""β of `descend_to`, beside squared centimetres."""
STEPS = 100


def project_observed(
    manifold: MotionManifold,
    features: np.ndarray,
    known: np.ndarray,
    near: float = NEAR,
    steps: int = STEPS,
) -> np.ndarray:
    """A motion with holes, filled in from the manifold.

    Holes are first filled along lines, for Φ to have something to start from. What the motion
    found misses the observed entries by is interpolated over the holes and taken away, so that
    nothing jumps where a hole begins or ends.

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
    straight = interpolate_linearly(np.where(known, features, manifold.mean_pose), known)
    # Every kind of features in the measure of positions: what the network takes for equal.
    weights = known * (manifold.scale / manifold.scale[0]) ** 2

    def wish(x: np.ndarray) -> tuple[float, np.ndarray]:
        loss, pullback = constraints.unlike(x, straight, weights)
        return constraints.CENTIMETRES * loss, pullback(constraints.CENTIMETRES)

    start = manifold.encode(straight)
    found = manifold.decode(
        descend_to(manifold, start, len(features), wish, near, steps), len(features)
    )
    missed = np.where(known, features - found, 0.0)
    return np.where(known, features, found + interpolate_linearly(missed, known))
