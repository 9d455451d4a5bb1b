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
  interpolated in the rig (`motion.retarget.curves.on_curves`), and `corrected` returns

      X_0 + s · a² / (a² + d²/4) · (X_N - X_0)

  for each joint and hole, with s from 0 to 1 from a table (`strengths`), a² the variance of the
  joint's position in the second before and the second after the hole, and d² the mean square of
  the correction X_N - X_0. Where a joint rests, the curve is nearly right and is hardly corrected.
  The differences X - P(X_n) are interpolated by the same curve (`eased`), which has the speed of
  the motion at both ends of the hole, so neither rotation nor speed jumps there.
- `fill` has only features, without a rig. X_0 is a spline (PCHIP) through positions in the body's
  frame, and in holes of a few frames the result is a mean of X_N and X_0.
"""

import json
from functools import cache
from importlib.resources import files

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import POSITIONS
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.masks import run_lengths, runs, runs_with
from numpy_cae.motion.motion import RATE
from numpy_cae.motion.retarget.curves import over_holes

REPEATS = 3
"""REPEATS: leg joints are projected this many times, all others once; by `fill` only in holes of at
least LONG frames. Chosen on sources left out of training (docs/lab_book/filling.md)."""
LONG = 30
"""LONG: the frames of a long hole; see REPEATS."""
SHORT = 16
"""SHORT: in `fill`, the spline, which is better in short holes, has a weight that falls from 0.8 to
0 as the hole grows to this many frames. Chosen like REPEATS."""
NEAR = 30
"""NEAR: the frames on each side of a hole in which a of the module's equation is measured."""
TINY = 1e-12
"""TINY: the least a² (m²), where a joint does not move at all."""
_ARMS = range(JOINTS.index("left_collar"), JOINTS.index("left_hip"))
_LEGS = range(JOINTS.index("left_hip"), len(JOINTS))
_ENDS = [joint for joint in range(len(JOINTS)) if joint not in PARENTS]


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


def corrected(
    manifold: MotionManifold,
    features: np.ndarray,
    missing: np.ndarray,
    strength: np.ndarray | None = None,
) -> np.ndarray:
    """A motion that starts on the rotation curves of its rig, corrected by the manifold.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        X_0, on the mean skeleton: missing joints are where they are in `on_curves`. A joint that is
        missing in all frames starts where it is in the mean pose.
    missing : (F, 20) array of bool
    strength : (F, 20) array of float, optional
        s of the module's equation; `strengths` by default.

    Returns
    -------
    (F, 63) array of float64
        Only the missing joints differ from `features`.
    """
    filled = np.array(features, dtype=np.float64)
    points = filled[:, POSITIONS].reshape(-1, len(JOINTS), 3)  # a view
    always = np.asarray(missing.all(axis=0))
    points[:, always] = manifold.mean_pose[POSITIONS].reshape(-1, 3)[always]
    kinds = kinds_of_holes(missing)
    strength = strengths(missing, kinds) if strength is None else strength
    if not (strength.any() or always.any()):
        return filled
    start, again = points.copy(), kinds == "leg"
    for unknown in [missing, *[again] * (REPEATS - 1 if again.any() else 0)]:
        projected = manifold.project(filled, average_shifts=True)[:, POSITIONS]
        projected = projected.reshape(points.shape)
        error = np.where(always[:, None], 0.0, start - projected)
        points[unknown] = (projected + over_holes(error, missing, RATE))[unknown]
    correction = points - start
    share = np.where(always, 1.0, strength * confidence(start, correction, missing))
    points[missing] = (start + share[..., None] * correction)[missing]
    return filled


def confidence(start: np.ndarray, correction: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """a² / (a² + d²/4) of the module's equation for each missing joint, (F, 20), else 0.

    Parameters
    ----------
    start, correction : (F, 20, 3) arrays of float
        X_0 and X_N - X_0, metres.
    missing : (F, 20) array of bool
    """
    share = np.zeros(missing.shape)
    for joint in np.flatnonzero(missing.any(axis=0)):
        for first, end in runs(missing[:, joint]):
            sides = slice(max(first - NEAR, 0), first), slice(end, end + NEAR)
            known = [start[side, joint][~missing[side, joint]] for side in sides]
            moved = np.mean([x.var(axis=0).sum() for x in known if len(x)] or [np.inf])
            corrected_by = np.mean(np.sum(correction[first:end, joint] ** 2, axis=-1))
            share[first:end, joint] = 1 / (1 + corrected_by / max(4 * moved, TINY))
    return share


def kinds_of_holes(missing: np.ndarray) -> np.ndarray:
    """The kind of hole in which each missing joint of a mask (F, 20) is: (F, 20) of str, else "".

    "end": the end of a limb alone, such as a wrist whose elbow is known; "arm", "leg": a joint of
    a limb; "pose": a joint of the trunk, and any joint of a hole in which the hips are missing.
    """
    kinds = np.full(missing.shape, "pose", dtype="U4")
    kinds[:, _ARMS], kinds[:, _LEGS] = "arm", "leg"
    with_parent = runs_with(missing, missing[:, [0, *PARENTS[1:]]])
    kinds[:, _ENDS] = np.where(with_parent, kinds, "end")[:, _ENDS]
    with_hips = runs_with(missing, np.repeat(missing[:, :1], len(JOINTS), axis=1))
    return np.where(missing, np.where(with_hips, "pose", kinds), "")


def strengths(missing: np.ndarray, kinds: np.ndarray) -> np.ndarray:
    """s of the module's equation for each joint, (F, 20), from the length and kind of its hole.

    The table stands in `fill_strengths.json`; docs/choose_fill_strengths.py makes it.
    """
    table, lengths, strength = strength_table(), run_lengths(missing), np.zeros(missing.shape)
    for kind, values in table["strengths"].items():
        here = kinds == kind
        strength[here] = np.interp(np.log(lengths[here]), np.log(table["lengths"]), values)
    return strength


@cache
def strength_table() -> dict:
    """Lengths of holes, in frames, and for each kind the strengths in holes of these lengths."""
    text = files("numpy_cae.manifold").joinpath("fill_strengths.json").read_text("utf-8")
    return json.loads(text)


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
