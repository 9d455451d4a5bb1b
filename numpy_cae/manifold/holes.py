"""Holes in a motion: frames and joints whose values are unknown, as a mask."""

from dataclasses import replace

import numpy as np
from scipy.ndimage import label

from numpy_cae.motion.motion import Motion, slerp
from numpy_cae.motion.retarget.to_body import RATE


def spline(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Values (F, N, …) interpolated over the frames and columns of the mask (F, N).

    The curve is a monotone cubic (PCHIP), which does not overshoot. Beyond the first and the last
    known frame their values are held; a column without known frames is left unchanged.
    """
    from scipy.interpolate import PchipInterpolator  # slow to import, and seldom needed

    filled = np.array(values, dtype=np.float64)
    frames = np.arange(len(filled))
    for column in np.flatnonzero(missing.any(axis=0) & ~missing.all(axis=0)):
        gaps, known = frames[missing[:, column]], frames[~missing[:, column]]
        if len(known) == 1:
            filled[gaps, column] = filled[known, column]
        else:
            curve = PchipInterpolator(known, filled[known, column])
            filled[gaps, column] = curve(np.clip(gaps, known[0], known[-1]))
    return filled


def hole_lengths(missing: np.ndarray) -> np.ndarray:
    """For each missing value of a mask (F, N), the frames of its hole: (F, N) of int, else 0."""
    holes, count = label(missing, np.array([[0, 1, 0]] * 3))
    lengths = np.bincount(holes.ravel(), minlength=count + 1)
    lengths[0] = 0
    return lengths[holes]


def at_thirty(motion: Motion, mask: np.ndarray) -> np.ndarray:
    """A mask (frames, N) of a file's frames at 30 a second: where a frame nearby is in it."""
    source = motion.source_frames(RATE)
    low, high = np.floor(source).astype(int), np.ceil(source).astype(int)
    return mask[low] | mask[np.minimum(high, len(motion) - 1)]


def in_file(motion: Motion, mask: np.ndarray) -> np.ndarray:
    """A mask (F, N) of frames at 30 a second in the frames of a file: up to the frames at 30 a
    second next to those of the mask, which are not in it."""
    source = motion.source_frames(RATE)
    after = np.searchsorted(source, np.arange(len(motion)), side="left")
    before = np.searchsorted(source, np.arange(len(motion)), side="right") - 1
    last = len(source) - 1
    return mask[np.minimum(after, last)] | mask[before]


def finite_motion(motion: Motion) -> tuple[Motion, np.ndarray]:
    """The motion with rotations and translations that are not finite interpolated, and which joints
    of the rig in which frames depend on such values: (frames, J) of bool."""
    wrong = ~(np.isfinite(motion.rotations).all(-1) & np.isfinite(motion.translations).all(-1))
    if not wrong.any():
        return motion, wrong
    rotations = np.where(wrong[..., None], [0.0, 0.0, 0.0, 1.0], motion.rotations)
    translations = np.where(wrong[..., None], motion.skeleton.offsets, motion.translations)
    for joint in np.flatnonzero(wrong.any(axis=0) & ~wrong.all(axis=0)):
        gaps, known = np.flatnonzero(wrong[:, joint]), np.flatnonzero(~wrong[:, joint])
        rotations[gaps, joint] = slerp(known, rotations[known, joint, None], gaps)[:, 0]
    translations = spline(translations, wrong)
    for child, parent in enumerate(motion.skeleton.parents):
        if parent >= 0:
            wrong[:, child] |= wrong[:, parent]
    return replace(motion, rotations=rotations, translations=translations), wrong
