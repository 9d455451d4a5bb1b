"""Holes in a motion: frames and joints whose values are unknown, as a mask."""

from dataclasses import replace

import numpy as np

from numpy_cae.motion.motion import RATE, Motion, rotations_at


def spline(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Values (F, N, …) interpolated over the frames and columns of the mask (F, N).

    The curve is a monotone cubic (PCHIP), which does not overshoot. Beyond the first and the last
    known frame their values are held; a column without known frames is left unchanged.
    """
    filled = np.array(values, dtype=np.float64)
    if not missing.any():
        return filled
    from scipy.interpolate import PchipInterpolator  # slow to import, and seldom needed

    frames = np.arange(len(filled))
    for column in np.flatnonzero(missing.any(axis=0) & ~missing.all(axis=0)):
        gaps, known = frames[missing[:, column]], frames[~missing[:, column]]
        if len(known) == 1:
            filled[gaps, column] = filled[known, column]
        else:
            curve = PchipInterpolator(known, filled[known, column])
            filled[gaps, column] = curve(np.clip(gaps, known[0], known[-1]))
    return filled


def stretches(mask: np.ndarray) -> np.ndarray:
    """For each True of a mask (F, N), the number, from 1 on, of its stretch of consecutive frames:
    (F, N) of int, else 0."""
    begins = np.diff(mask, axis=0, prepend=False) & mask
    return np.cumsum(begins.T).reshape(mask.T.shape).T * mask


def hole_lengths(missing: np.ndarray) -> np.ndarray:
    """For each missing value of a mask (F, N), the frames of its hole: (F, N) of int, else 0."""
    holes = stretches(missing)
    return np.bincount(holes.ravel())[holes] * missing


def whole_stretches(mask: np.ndarray, some: np.ndarray) -> np.ndarray:
    """The stretches of a mask (F, N) of which some value is in another mask: (F, N) bool."""
    numbers = stretches(mask)
    return np.isin(numbers, numbers[some & mask])


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
        rotations[gaps, joint] = rotations_at(known, rotations[known, joint, None], gaps)[:, 0]
    translations = spline(translations, wrong)
    for child, parent in enumerate(motion.skeleton.parents):
        if parent >= 0:
            wrong[:, child] |= wrong[:, parent]
    return replace(motion, rotations=rotations, translations=translations), wrong
