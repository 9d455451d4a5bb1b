"""Which foot stands on the floor, and when: a toe joint that is low and hardly moves.

The height was chosen on 88 takes of Bandai and 49 of CMU, whose floor is uneven. Percentage of
frames (Bandai, CMU) in which a toe is below a height:

    height    when it rests    when it moves faster than 1 m/s
    2.5 cm    99.9%, 80%       13%, 4%
    3.5 cm    100%, 90%        21%, 11%
"""

import numpy as np

from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.masks import widen_runs

FEET = (JOINTS.index("left_toe"), JOINTS.index("right_toe"))
"""The toe joints, left and right, at the ball of each foot."""
STANDING_METRES = 0.025
"""A toe that stands is at most this high above the floor."""
STANDING_METRES_PER_S = 0.45
"""A toe that stands is slower than this. A foot that rolls off its ball is slower, one that swings
through is four times as fast."""
_LEAST_FRAMES = 3
"""Gaps and contacts of fewer frames are noise, at every rate: at a high rate the speed of a single
frame is less certain."""


def floor_height(toes: np.ndarray) -> float:
    """The height of the floor, metres: the 5% quantile of the height of the lower toe of both
    (F, 2, 3)."""
    return float(np.quantile(toes[..., 1].min(axis=1), 0.05))


def find_contacts(positions: np.ndarray, rate: float) -> np.ndarray:
    """Whether each foot stands.

    A foot is in contact in a frame if its toe is within `STANDING_METRES` of the floor, which is at
    `floor_height`, and moves along it slower than `STANDING_METRES_PER_S`; gaps and contacts of
    less than three frames are noise.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    rate : float
        Frames a second.

    Returns
    -------
    (F, 2) array of bool
        Left and right.
    """
    if len(positions) < 2:
        return np.zeros((len(positions), 2), bool)
    toes = positions[:, FEET]
    speed = np.linalg.norm(np.gradient(toes[..., [0, 2]], axis=0), axis=-1) * rate
    stands = (toes[..., 1] < floor_height(toes) + STANDING_METRES) & (speed < STANDING_METRES_PER_S)
    # The edge values are repeated: a clip may begin and end in the middle of a step.
    padded = np.pad(stands, ((_LEAST_FRAMES, _LEAST_FRAMES), (0, 0)), mode="edge")
    margin = _LEAST_FRAMES // 2
    without_gaps = ~widen_runs(~widen_runs(padded, margin), margin)
    without_noise = widen_runs(~widen_runs(~without_gaps, margin), margin)
    return without_noise[_LEAST_FRAMES:-_LEAST_FRAMES]


def foot_sliding(positions: np.ndarray, rate: float) -> float:
    """The mean speed along the floor of the foot that stands, in centimetres a second.

        100 · rate · mean_{t in contact} ‖xz(p_{t+1,f(t)}) - xz(p_{t,f(t)})‖

    f(t) is the foot whose toe joint is the lower one from t to t + 1, and t is in contact if that
    toe is within `STANDING_METRES` of the floor. A swinging foot passes the floor as closely,
    at several metres a second, but meanwhile the other foot is lower. Unlike in `find_contacts` the
    speed has no bound, because a fast slide is what is to be measured. The height of the floor is
    `floor_height`, so that a motion that floats as a whole still slides.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    rate : float
        Frames a second.

    Returns
    -------
    float
        0 if nothing touches the floor, and for fewer than two frames.

    Raises
    ------
    ValueError
        If the positions are not those of the twenty joints.
    """
    positions = np.asarray(positions, dtype=np.float64)
    if positions.shape[1:] != (len(JOINTS), 3):
        raise ValueError(f"positions have shape {positions.shape}, expected (F, {len(JOINTS)}, 3)")
    return sliding_of(positions[:, FEET], rate)


def sliding_of(toes: np.ndarray, rate: float) -> float:
    """`foot_sliding` of both toes (F, 2, 3), centimetres a second."""
    speeds = foot_speeds(toes, rate)
    lower, stands = lower_foot(toes)
    return float(speeds[np.arange(len(lower)), lower][stands].mean()) if stands.any() else 0.0


def foot_speeds(toes: np.ndarray, rate: float) -> np.ndarray:
    """The speeds of both toes (F, 2, 3) along the floor, from each frame to the next, (F - 1, 2) in
    centimetres a second."""
    return 100 * rate * np.linalg.norm(np.diff(toes[..., [0, 2]], axis=0), axis=-1)


def lower_foot(toes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """From each frame to the next the index of the lower one of both toes (F, 2, 3), and whether
    that is on the floor, (F - 1,) each."""
    height = (toes[1:, :, 1] + toes[:-1, :, 1]) / 2
    floor = floor_height(toes) if len(height) else 0.0
    return height.argmin(axis=1), height.min(axis=1) <= floor + STANDING_METRES
