"""The mean magnitude of the joints' acceleration."""

import numpy as np


def jitter(positions: np.ndarray, rate: float) -> float:
    """Mean over joints and frames of the acceleration's magnitude, in m/s².

        mean_{t,j} ‖p_{t+1,j} - 2 p_{t,j} + p_{t-1,j}‖ · rate²

    It is to be compared with the truth's, as it is not best at 0: noise that changes from frame to
    frame increases it far more than the position error, and too much smoothing decreases it.

    Parameters
    ----------
    positions : (F, J, 3) array of float
        World positions in metres, of at least 3 frames.
    rate : float
        Frames a second.

    Raises
    ------
    ValueError
        If the positions are not (F, J, 3) or fewer than 3 frames.
    """
    if np.ndim(positions) != 3 or np.shape(positions)[2] != 3 or len(positions) < 3:
        raise ValueError(
            f"positions have shape {np.shape(positions)}, expected (3 frames or more, joints, 3)"
        )
    acceleration = np.diff(np.asarray(positions, dtype=np.float64), 2, axis=0) * rate**2
    return float(np.linalg.norm(acceleration, axis=-1).mean())
