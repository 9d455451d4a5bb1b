"""How far joints are from where they should be, in centimetres."""

from __future__ import annotations

import numpy as np

from numpy_cae.motion.features import POSITIONS


def position_error(
    features: np.ndarray, truth: np.ndarray, real: np.ndarray | None = None
) -> float:
    """Root mean square over the coordinates of all joints, in centimetres.

        100 · √ mean((q̂ - q)²)

    over the 60 position features, local to the body's place on the floor and its heading, so that
    a slip of the integrated path does not drown the pose.

    Parameters
    ----------
    features, truth : (…, F, 63) arrays of float
        In metres.
    real : (…, F) array of bool, optional
        Frames to count; held ones are False.
    """
    gap = (np.asarray(features) - truth)[..., POSITIONS]
    if real is not None:
        gap = gap[real]
    return float(100 * np.sqrt(np.mean(np.square(gap, dtype=np.float64))))
