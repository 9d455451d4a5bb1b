"""The axes, the floor and the joints of a motion's file, and the way to and from Y up.

A `Motion` is Y up with the floor at 0, and may have joints that its file lacks. `Motion.up`,
`Motion.floor` and `Skeleton.added` say how the file has it, and the writers restore that.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import nearest, product

TO_Y_UP = {
    "y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "x": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "-y": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "-z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-x": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
}
"""The rotation that takes a file whose up axis is this one to Y up, as rows of a matrix."""


def to_y_up(motion: Motion, up: str, floor: float) -> Motion:
    """The motion of a file turned to Y up, with its floor at 0; `as_in_file` is the inverse."""
    if up == "y" and floor == 0:
        return motion
    rotations, translations = _turned(motion, np.array(TO_Y_UP[up], dtype=float))
    translations[:, 0, 1] -= floor
    return replace(motion, rotations=rotations, translations=translations, up=up, floor=floor)


def as_in_file(motion: Motion) -> Motion:
    """The motion in the axes, at the height and with the joints of its file, for a writer."""
    motion = without_added(motion)
    if motion.up == "y" and motion.floor == 0:
        return motion
    translations = motion.translations.copy()
    translations[:, 0, 1] += motion.floor
    moved = replace(motion, translations=translations)
    rotations, translations = _turned(moved, np.array(TO_Y_UP[motion.up], dtype=float).T)
    return replace(motion, rotations=rotations, translations=translations, up="y", floor=0.0)


def _turned(motion: Motion, matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rotations and translations of the motion with its root turned."""
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    rotations[:, 0] = product(nearest(matrix), rotations[:, 0])
    translations[:, 0] = translations[:, 0] @ matrix.T
    return rotations, translations


def without_added(motion: Motion) -> Motion:
    """The motion of the joints that the file has."""
    skeleton = motion.skeleton
    if not skeleton.added:
        return motion
    kept = slice(len(skeleton.names) - skeleton.added)
    names, parents, offsets = skeleton.names[kept], skeleton.parents[kept], skeleton.offsets[kept]
    shorter = replace(skeleton, names=names, parents=parents, offsets=offsets, added=0)
    rotations, translations = motion.rotations[:, kept], motion.translations[:, kept]
    return replace(motion, skeleton=shorter, rotations=rotations, translations=translations)
