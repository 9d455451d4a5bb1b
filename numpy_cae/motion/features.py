"""The 63 features of holden2015, section 4, and their inverse.

The body's position on the floor and its heading are removed from every frame; their changes until
the next frame are kept instead. With h_t the hips on the floor, θ_t the heading, R(θ) the rotation
by θ about Y and p_t a joint's position:

    positions   q_t = R(-θ_t) (p_t - h_t)           60 numbers, metres
    velocity    v_t = R(-θ_t) (h_{t+1} - h_t)       x and z, metres a frame
    turn        ω_t = θ_{t+1} - θ_t                 radians a frame

and the inverse, from the first frame's h_0 and θ_0, by summation:

    θ_{t+1} = θ_t + ω_t,    h_{t+1} = h_t + R(θ_t) v_t,    p_t = h_t + R(θ_t) q_t

Before that, every body gets the mean bones of all: "We normalize the joint lengths". Each bone is
scaled by one ratio for the whole take, target length over own length, which keeps its direction.
The hips move by the ratio of the legs, so that a short person takes the mean person's steps and the
feet stay on the floor.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.motion.joints import JOINTS, PARENTS

POSITIONS = slice(0, 3 * len(JOINTS))
"""x, y and z of each of the twenty joints, metres."""
VELOCITY = slice(60, 62)
"""Movement of the hips along the body's x and z until the next frame, metres."""
TURN = slice(62, 63)
"""Rotation of the body about Y until the next frame, radians."""
FEATURES = 63
SMOOTHING_SECONDS = 1 / 3
"""Standard deviation of the Gaussian that smooths the heading: long enough to ignore the swing of
the shoulders within a step, short enough to keep a turn of the body."""


def joint_slice(joint: str) -> slice:
    """The columns of one joint's x, y and z in the features.

    Parameters
    ----------
    joint : str
        One of `JOINTS`, such as "left_wrist".

    Returns
    -------
    slice

    Examples
    --------
    >>> joint_slice("spine")
    slice(3, 6, None)
    """
    start = 3 * JOINTS.index(joint)
    return slice(start, start + 3)


@dataclass(frozen=True)
class RootTransform:
    """Position of a body on the floor in metres and its heading about Y in radians.

    Examples
    --------
    >>> RootTransform(x=1.0)  # a metre to the left of someone at the origin who faces +Z
    RootTransform(x=1.0, z=0.0, heading=0.0)
    """

    x: float = 0.0
    z: float = 0.0
    heading: float = 0.0


def positions_to_features(positions: np.ndarray, rate: float) -> tuple[np.ndarray, RootTransform]:
    """The features of a motion and its root transform in the first frame (section 4).

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

    Examples
    --------
    Someone who walks moves forwards, along his own z, at some 1.5 m/s:

    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import body_of
    >>> from numpy_cae.motion import RATE
    >>> walk = body_of(make_take("walk", 1, seconds=2.0, rate=30.0).motion)
    >>> features, start = positions_to_features(walk, RATE)
    >>> features.shape
    (60, 63)
    >>> (RATE * features[30, VELOCITY]).round(1)
    array([0.1, 1.6])
    """
    theta = heading(positions, rate)
    floor = positions[:, 0] * [1.0, 0.0, 1.0]
    features = np.zeros((len(positions), FEATURES))
    local = rotate_about_y(positions - floor[:, None], -theta[:, None])
    features[:, POSITIONS] = local.reshape(len(positions), -1)
    features[:, VELOCITY.start :] = velocities_along(floor, theta)
    return features, RootTransform(floor[0, 0], floor[0, 2], theta[0])


def velocities_along(floor: np.ndarray, theta: np.ndarray) -> np.ndarray:
    """Velocity and turn along a trajectory, v_t and ω_t, (F, 3) in the order of the features.

    Parameters
    ----------
    floor : (F, 3) array of float
        h_t, the hips' position on the floor in metres, as `trajectory_of` returns it.
    theta : (F,) array of float
        θ_t, the heading in radians.

    Returns
    -------
    (F, 3) array of float64
        The last frame repeats the one before.
    """
    steps = np.zeros((len(floor), 3))
    velocity = rotate_on_floor(np.diff(floor, axis=0)[:, [0, 2]], -theta[:-1])
    steps[:-1] = np.column_stack([velocity, np.diff(theta)])
    steps[-1] = steps[-2] if len(steps) > 1 else 0.0
    return steps


def features_to_positions(features: np.ndarray, start: RootTransform | None = None) -> np.ndarray:
    """World positions, by integrating the velocities from the first frame's root transform.

    Parameters
    ----------
    features : (F, 63) array of float
    start : RootTransform, optional
        By default the origin facing +Z.

    Returns
    -------
    (F, 20, 3) array of float64
        Metres.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import body_of
    >>> from numpy_cae.motion import RATE
    >>> walk = body_of(make_take("walk", 1, seconds=2.0, rate=30.0).motion)
    >>> features, start = positions_to_features(walk, RATE)
    >>> bool(np.allclose(features_to_positions(features, start), walk))
    True
    """
    features = np.asarray(features, dtype=np.float64)
    floor, theta = trajectory_of(features, start)
    return rotate_about_y(local_positions(features), theta[:, None]) + floor[:, None]


def local_positions(features: np.ndarray) -> np.ndarray:
    """The positions of the joints in features (F, 63), in the body's frame: a view (F, 20, 3)."""
    return features[:, POSITIONS].reshape(len(features), len(JOINTS), 3)


def trajectory_of(
    features: np.ndarray, start: RootTransform | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """The trajectory of a body: h_t (F, 3) in metres and θ_t (F,) in radians.

    It begins at `start`, by default at the origin facing +Z. In the code h is `floor`, θ `theta`.
    """
    start = start or RootTransform()
    theta = np.full(len(features), start.heading, dtype=np.float64)
    theta[1:] += np.cumsum(features[:-1, TURN.start])
    floor = np.tile([start.x, 0.0, start.z], (len(features), 1))
    steps = rotate_on_floor(features[:-1, VELOCITY], theta[:-1])
    floor[1:, [0, 2]] += np.cumsum(steps, axis=0)
    return floor, theta


def heading(positions: np.ndarray, rate: float) -> np.ndarray:
    """The smoothed angle about Y of a body's forward direction, (sin θ, 0, cos θ).

    Forward is perpendicular to Y and to the line from the right hip and shoulder to the left ones.
    It is smoothed as a vector, so that frames in which the body leans far over, and the line is
    short along the floor, have little weight.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions of the twenty joints.
    rate : float
        Frames a second.

    Returns
    -------
    (F,) array of float64
        Radians, 0 facing +Z, growing towards +X, unwrapped: without jumps of 2π.
    """
    at = {joint: positions[:, index] for index, joint in enumerate(JOINTS)}
    across = at["left_shoulder"] - at["right_shoulder"] + at["left_hip"] - at["right_hip"]
    forward = np.cross(across, [0.0, 1.0, 0.0])
    forward = smooth(forward, SMOOTHING_SECONDS * rate)
    return np.unwrap(np.arctan2(forward[:, 0], forward[:, 2]))


def smooth(values: np.ndarray, sigma: float) -> np.ndarray:
    """Values (F, C) smoothed along time by a Gaussian with a standard deviation of `sigma` frames,
    as `scipy.ndimage.gaussian_filter1d` does; the first and the last value are held."""
    radius = int(4 * sigma + 0.5)
    weights = np.exp(-0.5 * (np.arange(-radius, radius + 1) / sigma) ** 2)
    held = np.pad(values, ((radius, radius), (0, 0)), mode="edge")
    weights /= weights.sum()
    columns = [np.convolve(column, weights, "valid") for column in held.T]
    return np.stack(columns, axis=1)


def rotate_about_y(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """R(θ) v: vectors (…, 3) rotated about Y by angles in radians that broadcast to (…)."""
    floor = rotate_on_floor(vectors[..., [0, 2]], angles)
    y = np.broadcast_to(vectors[..., 1], floor.shape[:-1])
    return np.stack([floor[..., 0], y, floor[..., 1]], axis=-1)


def rotate_on_floor(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """The x and z of `rotate_about_y`: (x cos θ + z sin θ, z cos θ - x sin θ) of (…, 2)."""
    cos = np.cos(angles)
    sin = np.sin(angles)
    x = vectors[..., 0]
    z = vectors[..., 1]
    return np.stack([x * cos + z * sin, z * cos - x * sin], axis=-1)


_LEGS = [JOINTS.index(joint) for joint in ("left_knee", "left_ankle", "right_knee", "right_ankle")]
"""The joints where the thighs and the shins end."""
_NO_LENGTH = 1e-6
"""A bone shorter than this (m) has no direction. In the CMU BVH files both collars are exactly at
the chest."""
LEGS = (0.05, 20.0)
"""A person's two legs together, thighs and shins, are between these lengths (m); an adult's are
about 1.7."""


def bone_lengths(positions: np.ndarray) -> np.ndarray:
    """The mean length of the bone that ends at each of the twenty joints.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions of the twenty joints in metres.

    Returns
    -------
    (20,) array of float64
        Metres; 0 for the hips, where no bone ends.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import body_of
    >>> walk = body_of(make_take("walk", 1, seconds=2.0, rate=30.0).motion)
    >>> float(bone_lengths(walk)[JOINTS.index("left_knee")].round(2))  # the thigh
    0.44
    """
    return frame_lengths(positions).mean(axis=0)


def frame_lengths(positions: np.ndarray) -> np.ndarray:
    """The lengths in each frame, (F, 20)."""
    lengths = np.zeros(positions.shape[:2])  # no bone ends at the hips
    for joint, parent in enumerate(PARENTS[1:], start=1):  # an hour of all bones takes 0.2 GB
        lengths[:, joint] = np.linalg.norm(positions[:, joint] - positions[:, parent], axis=-1)
    return lengths


def problem_of(positions: np.ndarray) -> str:
    """Why positions (F, 20, 3) in metres are not those of a person whose bones `change_lengths` can
    scale; empty if they are. A bone of length 0 is allowed only below a bone of
    positive length."""
    if not np.isfinite(positions).all():
        return "some frames have values that are not numbers; `numpy-cae repair` fills them in"
    # A few damaged frames do not change the median.
    return problem_of_lengths(np.median(frame_lengths(positions), axis=0))


def problem_of_lengths(lengths: np.ndarray) -> str:
    """The same of bone lengths (20,) in metres."""
    legs = lengths[_LEGS].sum()
    if not LEGS[0] <= legs <= LEGS[1]:
        problem = f"the bones to both knees and ankles are {legs:.3g} m long in all"
        if legs <= _NO_LENGTH:
            return f"{problem}: do position channels of 0 replace the offsets of its joints?"
        return f"{problem}, expected {LEGS[0]:g} to {LEGS[1]:g} m; is the unit another?"
    for joint, parent in enumerate(PARENTS[1:], start=1):
        if lengths[joint] <= _NO_LENGTH and (parent == 0 or lengths[parent] <= _NO_LENGTH):
            problem = f"the bone to {JOINTS[joint]} has no length: the joint is at {JOINTS[parent]}"
            return f"{problem}; is this a person? `numpy-cae rig FILE` lists its joints"
    return ""


def change_lengths(positions: np.ndarray, lengths: np.ndarray, target: np.ndarray) -> np.ndarray:
    """The same motion on bones of other lengths; `lengths` and `target` exchanged give the inverse.

    Parameters
    ----------
    positions : (F, 20, 3) array of float
        World positions in metres.
    lengths, target : (20,) arrays of float
        Bone lengths in metres, as `bone_lengths` returns them: of these positions, and of the
        result. A bone of length 0 in `lengths` has no direction:
        in the result it gets that of the bone above it.

    Returns
    -------
    (F, 20, 3) array of float64
        World positions in metres.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import body_of
    >>> walk = body_of(make_take("walk", 1, seconds=2.0, rate=30.0).motion)
    >>> lengths = bone_lengths(walk)
    >>> taller = change_lengths(walk, lengths, 1.1 * lengths)
    >>> bool(np.allclose(bone_lengths(taller), 1.1 * lengths))
    True
    """
    changed = np.empty(positions.shape)
    changed[:, 0] = positions[:, 0] * (target[_LEGS].sum() / lengths[_LEGS].sum())
    for joint, parent in enumerate(PARENTS[1:], start=1):
        if lengths[joint] > _NO_LENGTH:
            bone = (positions[:, joint] - positions[:, parent]) * (target[joint] / lengths[joint])
        else:
            bone_above = changed[:, parent] - changed[:, PARENTS[parent]]
            ratio = target[joint] / target[parent] if target[parent] > _NO_LENGTH else 0.0
            bone = bone_above * ratio
        changed[:, joint] = changed[:, parent] + bone
    return changed


def features_on_mean_skeleton(
    takes: Sequence[np.ndarray], rate: float
) -> tuple[list[np.ndarray], np.ndarray]:
    """The features of each take on the mean bones of all takes.

    Parameters
    ----------
    takes : sequence of (F, 20, 3) arrays of float
        World positions of the twenty joints in metres.
    rate : float
        Frames a second.

    Returns
    -------
    features : list of (F, 63) arrays of float64
    lengths : (20,) array of float64
        The mean bone lengths in metres; each take has the same weight.
    """
    lengths_of_takes = [bone_lengths(take) for take in takes]
    mean = np.mean(lengths_of_takes, axis=0)
    features_of_takes = []
    for take, lengths in zip(takes, lengths_of_takes, strict=True):
        features, _ = positions_to_features(change_lengths(take, lengths, mean), rate)
        features_of_takes.append(features)
    return features_of_takes, mean
