"""Filling in missing joints and poses (holden2015, section 7, "Filling in Missing Data").

The paper projects a motion whose missing values are zero. Here it is known which values are
missing, so the motion starts as an interpolation of the others. The motion is projected, Φ†(Φ(X)),
and the difference from the motion on both sides of a hole is interpolated over the hole, so that
there is no jump:

    X_0 = interpolation of X,    X_{n+1} = P(X_n) + interpolation of (X - P(X_n)),

with the projection P averaged over all shifts of the pooling grid. Only missing values are taken
from it; all other values are unchanged. Arrays are at thirty frames a second, (F, …).

Where X_0 comes from:

- `fill_motion` and `repair` have a motion in a rig. X_0 is the motion whose unknown rotations are
  on curves (`on_curves`), and `corrected` returns X_0 + s (X_N - X_0) for each joint and hole.
  `repair.trials` chooses the curves and s in the known frames of the same motion. The differences
  X - P(X_n) are interpolated by a curve with the speed of the motion at both ends of the hole.
- `fill` has only features, without a rig. X_0 is a spline (PCHIP) through positions in the body's
  frame, and in holes of a few frames the result is a mean of X_N and X_0.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import POSITIONS, local_positions
from numpy_cae.motion.hole_curves import over_holes
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.key_curves import pchip
from numpy_cae.motion.masks import run_lengths, runs_with
from numpy_cae.motion.motion import RATE

REPEATS = 3
"""REPEATS: leg joints are projected this many times, all others once; by `fill` only in holes of at
least LONG frames. Chosen on sources left out of training (docs/lab_book/filling.md)."""
REPEATS_ON_CURVES = 5
"""REPEATS_ON_CURVES: the same for `corrected`, in holes of any length in the legs."""
LONG = 30
"""LONG: the frames of a long hole; see REPEATS."""
SHORT = 16
"""SHORT: in `fill`, the spline, which is better in short holes, has a weight that falls from 0.8 to
0 as the hole grows to this many frames. Chosen like REPEATS."""
_ARMS = range(JOINTS.index("left_collar"), JOINTS.index("left_hip"))
_LEGS = range(JOINTS.index("left_hip"), len(JOINTS))
_ENDS = [joint for joint in range(len(JOINTS)) if joint not in PARENTS]


def fill(manifold: MotionManifold, features: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Fill in the joints of a motion that are missing.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the mean skeleton, at thirty frames a second. Positions of missing joints are ignored;
        velocity and turn are kept.
    missing : (F, 20) array of bool
        A joint that is missing in all frames starts where it is in the mean pose.

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
    The mean error in metres of an ankle that is missing for a second:

    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> from numpy_cae.mocap import body_of
    >>> manifold = starter()
    >>> walk = body_of(make_take("walk", 0, seconds=4.0, rate=30.0).motion)
    >>> features, _ = manifold.features(walk)
    >>> missing = np.zeros((120, 20), bool)
    >>> missing[30:60, JOINTS.index("left_ankle")] = True
    >>> gap = (fill(manifold, features, missing) - features)[:, POSITIONS]
    >>> print(np.linalg.norm(gap.reshape(-1, 20, 3), axis=-1)[missing].mean().round(2))
    0.05
    """
    missing = checked_mask(missing, len(features))
    lengths = run_lengths(missing)
    again = missing & (lengths >= LONG) & np.isin(np.arange(len(JOINTS)), _LEGS)
    masks = [missing, *[again] * (REPEATS - 1 if again.any() else 0)]
    share = np.minimum(1.0, 0.2 + 0.8 * lengths / SHORT)
    started = _with_mean_pose(manifold, features, missing)
    points = local_positions(started)  # a view
    points[...] = spline(points, missing)
    return _projected(manifold, started, masks, spline, share)


def corrected(
    manifold: MotionManifold, features: np.ndarray, missing: np.ndarray, strength: np.ndarray
) -> np.ndarray:
    """A motion that starts on the rotation curves of its rig, corrected by the manifold.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        X_0, on the mean skeleton: missing joints are where they are in `on_curves`. A joint that is
        missing in all frames starts where it is in the mean pose.
    missing : (F, 20) array of bool
    strength : (F, 20) array of float
        s of the module's equation; 1 is taken for joints that are missing in all frames.

    Returns
    -------
    (F, 63) array of float64
        Only the missing joints differ from `features`.
    """
    started = _with_mean_pose(manifold, features, missing)
    again = kinds_of_holes(missing) == b"leg"
    masks = [missing, *[again] * (REPEATS_ON_CURVES - 1 if again.any() else 0)]
    share = np.where(missing.all(axis=0), 1.0, strength) * missing
    return _projected(manifold, started, masks, partial(over_holes, rate=RATE), share)


def _with_mean_pose(
    manifold: MotionManifold, features: np.ndarray, missing: np.ndarray
) -> np.ndarray:
    """A copy (F, 63) with joints that are missing in all frames where they are in the mean pose."""
    features = np.array(features, dtype=np.float64)
    always = np.repeat(missing.all(axis=0), 3)
    features[:, POSITIONS][:, always] = manifold.mean_pose[POSITIONS][always]
    return features


def _projected(
    manifold: MotionManifold,
    start: np.ndarray,
    masks: list[np.ndarray],
    interpolate: Callable[[np.ndarray, np.ndarray], np.ndarray],
    share: np.ndarray,
) -> np.ndarray:
    """X_0 + share · (X_N - X_0) by the module's equation, of X_0 (F, 63) and shares (F, 20).

    In iteration n the joints of the n-th mask (F, 20) are changed; the first are all that are
    missing.
    """
    filled = start.copy()
    points, initial = map(local_positions, (filled, start))
    missing, always = masks[0], np.asarray(masks[0].all(axis=0))[:, None]
    for unknown in masks if share.any() else []:
        projected = local_positions(manifold.project(filled, average_shifts=True))
        error = interpolate(np.where(always, 0.0, points - projected), missing)
        points[unknown] = (projected + error)[unknown]
    points[missing] = (initial + share[..., None] * (points - initial))[missing]
    return filled


def kinds_of_holes(missing: np.ndarray) -> np.ndarray:
    """The kind of hole in which each missing joint of a mask (F, 20) is, bytes (F, 20), else b"".

    "end": the end of a limb alone, such as a wrist whose elbow is known; "arm", "leg": a joint of
    a limb; "pose": a joint of the trunk, and any joint of a hole in which the hips are missing.
    Text would take four times the memory of bytes, 0.6 GB for an hour at 120 Hz.
    """
    kinds = np.full(missing.shape, b"pose")
    kinds[:, _ARMS], kinds[:, _LEGS] = b"arm", b"leg"
    with_parent = runs_with(missing, missing[:, [0, *PARENTS[1:]]])
    kinds[:, _ENDS] = np.where(with_parent, kinds, b"end")[:, _ENDS]
    with_hips = runs_with(missing, np.repeat(missing[:, :1], len(JOINTS), axis=1))
    return np.where(missing, np.where(with_hips, b"pose", kinds), b"")


def spline(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Values (F, N, …) interpolated over the frames and columns of a mask (F, N).

    The curve is a monotone cubic (PCHIP), which does not overshoot. Before the first and after the
    last frame that is not missing, the value of that frame is repeated. A column that is missing in
    all frames is left unchanged.
    """
    return over_holes(values, missing, RATE, lambda *_: pchip)


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
