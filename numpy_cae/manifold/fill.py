"""Filling in missing joints and poses (holden2015, section 7, "Filling in Missing Data").

The paper projects a motion whose missing values are zero. Here it is known which values are
missing, so the motion starts as an interpolation of the others. The motion is projected, Φ†(Φ(X)),
and the difference from the motion on both sides of a hole is interpolated over the hole, so that
there is no jump:

    X_0 = spline of X,    X_{n+1} = P(X_n) + spline of (X - P(X_n)),

with the projection P averaged over all shifts of the pooling grid. In holes of a few frames the
result is a mean of this and the spline. Only missing values are taken from it; all other values are
unchanged. Arrays are at thirty frames a second, (F, …).
"""

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import POSITIONS, RootTransform, positions_to_features
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.lengths import change_lengths
from numpy_cae.motion.masks import run_lengths
from numpy_cae.motion.motion import RATE
from numpy_cae.motion.retarget.body import Body

REPEATS = 3
"""REPEATS: leg joints in holes of at least LONG frames are projected this many times, all
others once. Chosen on sources left out of training (docs/lab_book/filling.md)."""
LONG = 30
"""LONG: the frames of a long hole; see REPEATS."""
SHORT = 16
"""SHORT: the spline, which is better in short holes, has a weight that falls from 0.8 to 0 as the
hole grows to this many frames. Chosen like REPEATS."""
_LEGS = range(JOINTS.index("left_hip"), len(JOINTS))


def fill(
    manifold: MotionManifold, features: np.ndarray, missing: np.ndarray, repeats: int = REPEATS
) -> np.ndarray:
    """Fill in the joints of a motion that are missing.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton, at thirty frames a second. Positions of missing joints are ignored;
        velocity and turn are kept.
    missing : (F, 20) array of bool
        A joint that is missing in all frames starts where it is in the mean pose.
    repeats : int
        Number of projections of long holes in the legs. With 0 the result is the spline.

    Returns
    -------
    (F, 63) array of float64
        Only the missing joints differ from `features`.

    Raises
    ------
    ValueError
        If `missing` has another shape.

    Examples
    --------
    The mean error in metres of an ankle that is missing for a second, on a spline and filled in:

    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> manifold = starter()
    >>> features = manifold.body(make_take("walk", 0, seconds=4.0, rate=30.0).motion).features
    >>> missing = np.zeros((120, 20), bool)
    >>> missing[30:60, JOINTS.index("left_ankle")] = True
    >>> for repeats in (0, 3):
    ...     gap = (fill(manifold, features, missing, repeats) - features)[:, POSITIONS]
    ...     print(np.linalg.norm(gap.reshape(-1, 20, 3), axis=-1)[missing].mean().round(2))
    0.36
    0.05
    """
    missing = checked_mask(missing, len(features))
    filled = np.array(features, dtype=np.float64)
    points = filled[:, POSITIONS].reshape(-1, len(JOINTS), 3)  # a view
    always = np.asarray(missing.all(axis=0))
    points[:, always] = manifold.mean_pose[POSITIONS].reshape(-1, 3)[always]
    points[...] = spline(points, missing)
    if repeats == 0 or not missing.any():
        return filled
    start, lengths = points[missing], run_lengths(missing)
    again = missing & (lengths >= LONG) & np.isin(np.arange(len(JOINTS)), _LEGS)
    for unknown in [missing, *[again] * (repeats - 1 if again.any() else 0)]:
        projected = manifold.project(filled, average_shifts=True)[:, POSITIONS]
        projected = projected.reshape(points.shape)
        error = np.where(always[:, None], 0.0, points - projected)
        points[unknown] = (projected + spline(error, missing))[unknown]
    share = np.minimum(1.0, 0.2 + 0.8 * lengths[missing] / SHORT)[:, None]
    points[missing] = start + share * (points[missing] - start)
    return filled


def spline(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Values (F, N, …) interpolated over the frames and columns of a mask (F, N).

    The curve is a monotone cubic (PCHIP), which does not overshoot. Before the first and after the
    last frame that is not missing, the value of that frame is repeated. A column that is missing in
    all frames is left unchanged.
    """
    filled = np.array(values, dtype=np.float64)
    if not missing.any():
        return filled
    from scipy.interpolate import PchipInterpolator  # slow to import, and seldom needed

    frames = np.arange(len(filled))
    for column in np.flatnonzero(missing.any(axis=0) & ~missing.all(axis=0)):
        gaps, given = frames[missing[:, column]], frames[~missing[:, column]]
        if len(given) == 1:
            filled[gaps, column] = filled[given, column]
        else:
            curve = PchipInterpolator(given, filled[given, column])
            filled[gaps, column] = curve(np.clip(gaps, given[0], given[-1]))
    return filled


def bridged_features(body: Body, missing: np.ndarray) -> tuple[np.ndarray, RootTransform]:
    """The features (F, 63) of a motion and its root transform, with missing joints (F, 20) on a
    spline in the world, so that they do not distort the heading and the path of the hips."""
    positions = spline(body.positions, missing)
    positions = change_lengths(positions, body.lengths, body.mean_lengths)
    return positions_to_features(positions, RATE)


def keyframe_mask(frames: int, every: int) -> np.ndarray:
    """What is missing where every n-th frame, from the first on, is a keyframe.

    Frames after the last keyframe are not missing: they stay as they are in the file.

    Parameters
    ----------
    frames : int
        The number of frames of the file.
    every : int
        n.

    Returns
    -------
    (frames, 20) array of bool
        In the frames of the file, as `fill_motion` takes it.

    Raises
    ------
    ValueError
        If `every` is less than 1.

    Examples
    --------
    >>> keyframe_mask(8, 3)[:, 0].astype(int)
    array([0, 1, 1, 0, 1, 1, 0, 0])
    """
    if every < 1:
        raise ValueError(f"keyframes every {every} frames, expected 1 or more")
    frame = np.arange(frames)
    between = (frame % every > 0) & (frame < (frames - 1) // every * every)
    return np.repeat(between[:, None], len(JOINTS), axis=1)


def checked_mask(missing: np.ndarray, frames: int) -> np.ndarray:
    """The mask as an array of bool; ValueError unless it is (frames, 20)."""
    if np.shape(missing) != (frames, len(JOINTS)):
        raise ValueError(f"missing has shape {np.shape(missing)}, expected ({frames}, 20)")
    return np.asarray(missing, dtype=bool)
