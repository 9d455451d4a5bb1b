"""Which foot stands on the floor, and when: a toe joint that is low and hardly moves."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import binary_closing, binary_opening

from numpy_cae.motion.joints import JOINTS

FEET = (JOINTS.index("left_toe"), JOINTS.index("right_toe"))
"""The joint of each foot that stands: the ball of the foot."""
HEIGHT = 0.035
"""Metres above the floor below which a toe may stand."""
SPEED = 0.45
"""Metres a second below which it does. A foot that rolls off its ball is slower, one that swings
through is four times as fast."""
_BRIEF = 3


def floor_height(positions: np.ndarray) -> float:
    """Metres: what the lower toe is below for a twentieth of the time.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    """
    return float(np.quantile(positions[:, FEET, 1].min(axis=1), 0.05))


def find_contacts(positions: np.ndarray, rate: float, floor: float | None = None) -> np.ndarray:
    """Whether each foot stands.

    A foot is in contact at a frame where its toe is within `HEIGHT` of the floor and moves along it
    slower than `SPEED`; gaps and contacts of less than three frames are taken for noise.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    rate : float
        Frames a second.
    floor : float, optional
        Its height in metres; `floor_height` where None.

    Returns
    -------
    (F, 2) array of bool
        Left and right.
    """
    if len(positions) < 2:
        return np.zeros((len(positions), 2), bool)
    floor = floor_height(positions) if floor is None else floor
    toes = positions[:, FEET]
    speed = np.linalg.norm(np.gradient(toes[..., [0, 2]], axis=0), axis=-1) * rate
    stands = (toes[..., 1] < floor + HEIGHT) & (speed < SPEED)
    for foot in stands.T:
        # Edges are continued as they are: a clip may begin and end in the middle of a step.
        longer = np.pad(foot, _BRIEF, mode="edge")
        steady = binary_opening(binary_closing(longer, np.ones(_BRIEF)), np.ones(_BRIEF))
        foot[:] = steady[_BRIEF:-_BRIEF]
    return stands
