"""The speed at which the standing foot slides over the floor, 0 in an ideal motion."""

import numpy as np

from numpy_cae.motion.contacts import FEET, STANDING_HEIGHT, floor_height
from numpy_cae.motion.joints import JOINTS


def foot_sliding(positions: np.ndarray, rate: float, floor: float | None = None) -> float:
    """The mean speed along the floor of the foot that stands, in centimetres a second.

        100 · rate · mean_{t in contact} ‖xz(p_{t+1,f(t)}) - xz(p_{t,f(t)})‖

    f(t) is the foot whose toe joint is the lower one from t to t + 1, and t is in contact if that
    toe is within `STANDING_HEIGHT` of the floor. A swinging foot passes the floor as closely,
    at several metres a second, but meanwhile the other foot is lower. There is no bound on the
    speed, as in `find_contacts`, because a fast slide is what is to be measured.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    rate : float
        Frames a second.
    floor : float, optional
        Its height in metres; by default `floor_height`, so that a motion that floats as a whole
        still slides.

    Returns
    -------
    float
        0 if nothing touches the floor.

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
    toes = positions[:, FEET]
    height = (toes[1:, :, 1] + toes[:-1, :, 1]) / 2
    lower, frames = height.argmin(axis=1), np.arange(len(height))
    speed = np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1)[frames, lower] * rate
    ground = floor_height(positions) if floor is None else floor
    contact = height[frames, lower] <= ground + STANDING_HEIGHT
    return float(100 * speed[contact].mean()) if contact.any() else 0.0
