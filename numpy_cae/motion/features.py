"""The 63 features of holden2015, section 4, and the way back.

Of every frame the body's place on the floor and its heading are taken away; how both change until
the next frame is kept instead. With h_t the hips on the floor, θ_t the heading, R(θ) the rotation
by θ about Y and p_t a joint's position:

    positions   q_t = R(-θ_t) (p_t - h_t)           60 numbers, metres
    velocity    v_t = R(-θ_t) (h_{t+1} - h_t)       x and z, metres a frame
    turn        ω_t = θ_{t+1} - θ_t                 radians a frame

and back, from the first frame's h_0 and θ_0, by summing up:

    θ_{t+1} = θ_t + ω_t,    h_{t+1} = h_t + R(θ_t) v_t,    p_t = h_t + R(θ_t) q_t
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.heading import heading
from numpy_cae.motion.joints import JOINTS

POSITIONS = slice(0, 3 * len(JOINTS))
"""x, y and z of each of the twenty joints, metres."""
VELOCITY = slice(60, 62)
"""How far the hips move along the body's x and z until the next frame, metres."""
TURN = slice(62, 63)
"""How far the body turns about Y until the next frame, radians."""
FEATURES = 63


def joint_slice(joint: str) -> slice:
    """The three features of one joint, such as "left_wrist"."""
    start = 3 * JOINTS.index(joint)
    return slice(start, start + 3)


@dataclass(frozen=True)
class RootTransform:
    """Where a body stands and faces: metres along X and Z, radians about Y."""

    x: float = 0.0
    z: float = 0.0
    heading: float = 0.0


def positions_to_features(positions: np.ndarray, rate: float) -> tuple[np.ndarray, RootTransform]:
    """The features of a motion and the place where it starts.

    The last frame has no next one; its velocity and turn repeat those of the frame before.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions of the twenty joints in metres, bones already normalised.
    rate : float
        Frames a second, for the smoothing of the heading.

    Returns
    -------
    features : (F, 63) array of float64
    start : RootTransform
        Of the first frame.

    References
    ----------
    holden2015, section 4.
    """
    theta = heading(positions, rate)
    floor = positions[:, 0] * [1.0, 0.0, 1.0]
    features = np.zeros((len(positions), FEATURES))
    local = _turned(positions - floor[:, None], -theta)
    features[:, POSITIONS] = local.reshape(len(positions), -1)
    features[:, VELOCITY.start :] = velocities_along(floor, theta)
    return features, RootTransform(floor[0, 0], floor[0, 2], theta[0])


def velocities_along(floor: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Velocity and turn, v_t and ω_t, of a body that goes a way: the inverse of `trajectory_of`.

    Parameters
    ----------
    floor : (F, 3) array of float
        The hips on the floor, h_t, metres.
    theta : (F,) array of float
        The heading, θ_t, radians.

    Returns
    -------
    (F, 3) array of float64
        In the order of the features; the last frame repeats the one before.
    """
    steps = np.zeros((len(floor), 3))
    velocity = _turned(np.diff(floor, axis=0)[:, None], -theta[:-1])[:, 0]
    steps[:-1] = np.column_stack([velocity[:, [0, 2]], np.diff(theta)])
    steps[-1] = steps[-2] if len(steps) > 1 else 0.0
    return steps


def features_to_positions(features: np.ndarray, start: RootTransform | None = None) -> np.ndarray:
    """World positions by integrating the velocities, from the first frame's place on.

    Parameters
    ----------
    features : (F, 63) array of float
    start : RootTransform, optional
        The origin facing +Z where none is given.

    Returns
    -------
    (F, 20, 3) array of float64
        Metres.
    """
    frames = len(features)
    features = np.asarray(features, dtype=np.float64)
    floor, theta = trajectory_of(features, start)
    local = features[:, POSITIONS].reshape(frames, len(JOINTS), 3)
    return _turned(local, theta) + floor[:, None]


def trajectory_of(
    features: np.ndarray, start: RootTransform | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """The way that a body goes: h_t (F, 3) in metres and θ_t (F,) in radians.

    Parameters
    ----------
    features : (F, 63) array of float
    start : RootTransform, optional
        The origin facing +Z where none is given.
    """
    start = start or RootTransform()
    theta = start.heading + _running_sum(features[:-1, TURN.start])
    steps = np.zeros((len(features) - 1, 1, 3))
    steps[:, 0, [0, 2]] = features[:-1, VELOCITY]
    steps = _turned(steps, theta[:-1])[:, 0]
    floor = np.stack([_running_sum(step) for step in steps.T], axis=-1)
    return floor + [start.x, 0.0, start.z], theta


def _running_sum(steps: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(steps)])


def _turned(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Each frame's vectors (F, N, 3) turned about Y by that frame's angle (F,)."""
    about_y = Rotation.from_rotvec(angles[:, None] * [0.0, 1.0, 0.0]).as_matrix()
    return vectors @ about_y.transpose(0, 2, 1)
