"""How fast the standing foot slides over the floor: a foot that stands should not."""

from __future__ import annotations

import numpy as np

from numpy_cae.motion.joints import JOINTS

_TOES = [JOINTS.index("left_toe"), JOINTS.index("right_toe")]
HEIGHT = 0.025
"""Metres above the floor within which a toe joint is taken to stand on it."""
_FLOOR_SHARE = 0.05


def foot_sliding(positions: np.ndarray, rate: float, floor: float | None = None) -> float:
    """The mean speed along the floor of the foot that stands, in centimetres a second.

        100 · rate · mean_{t in contact} ‖xz(p_{t+1,f(t)}) - xz(p_{t,f(t)})‖

    f(t) is the foot whose toe joint is the lower one from t to t + 1, and t is in contact where
    that toe is within `HEIGHT` of the floor. A swinging foot passes the floor as closely as that,
    at several metres a second, but while it does the other one stands lower. No speed is asked
    for: a foot that slides fast is what is to be found.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    rate : float
        Frames a second.
    floor : float, optional
        Its height in metres. Where none is given, that below which the lower toe is for a
        twentieth of the time: a motion that floats as a whole still slides.

    Returns
    -------
    float
        0 where nothing touches the floor.

    Raises
    ------
    ValueError
        If the positions are not those of the twenty joints in two frames or more.
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.ndim != 3 or positions.shape[1:] != (len(JOINTS), 3) or len(positions) < 2:
        raise ValueError(
            f"positions have shape {positions.shape}, expected (2 frames or more, 20, 3)"
        )
    toes = positions[:, _TOES]
    height = (toes[1:, :, 1] + toes[:-1, :, 1]) / 2
    lower, frames = height.argmin(axis=1), np.arange(len(height))
    speed = np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1)[frames, lower] * rate
    lowest = height[frames, lower]
    ground = np.quantile(lowest, _FLOOR_SHARE) if floor is None else floor
    contact = lowest <= ground + HEIGHT
    return float(100 * speed[contact].mean()) if contact.any() else 0.0
