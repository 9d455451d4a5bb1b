"""A motion as the 54 numbers a frame of jang2018, and back.

A joint's rotation is taken relative to the nearest joint above it that is in the table, so that
what lies between (a second bone of the spine, a collar) is folded in and every joint of the table
faces where it faced:

    R_j = G_aboveᵀ · G_j
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.angle_table import TRANSLATION, AngleTable, table_for
from numpy_cae.motion.io.load import load_motion
from numpy_cae.motion.io.t_pose import without_t_pose
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import UnknownRigError
from numpy_cae.motion.skeleton import Skeleton
from numpy_cae.motion.unwrap import unwrapped

ANGLE_RATE = 25.0
"""Frames a second, as MBR17 has Human3.6M: half of its fifty."""


@dataclass(frozen=True)
class AngleSequence:
    """A motion in joint space.

    Parameters
    ----------
    numbers : (F, 54) array of float64
        The root's place in the world in metres and 51 angles in radians, unwrapped in time, in the
        order of `table.columns`.
    table : AngleTable
    offsets : (J, 3) array of float64
        From each drawn joint's carrier to the joint in metres, mean over the motion.
    """

    numbers: np.ndarray
    table: AngleTable
    offsets: np.ndarray

    def __len__(self) -> int:
        return len(self.numbers)


def angles_of(motion: Motion, mapping: dict[str, str] | None = None) -> AngleSequence:
    """The motion at 25 frames a second, without the T-pose before it, as 54 numbers a frame.

    Parameters
    ----------
    motion : Motion
        At the rate of its file.
    mapping : dict, optional
        As `find_joints` takes it.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    table = table_for(motion.skeleton)
    found = table.locate(motion.skeleton, mapping)
    motion = without_t_pose(motion, mapping).resampled(ANGLE_RATE)
    positions, turned = motion.forward_kinematics()
    vectors = np.zeros((len(motion), len(found), 3))
    offsets = np.zeros((len(found), 3))
    for joint, above in enumerate(table.carriers):
        here = turned[found[joint]]
        if above >= 0:
            carrier = turned[found[above]].inv()
            reach = positions[:, found[joint]] - positions[:, found[above]]
            offsets[joint] = carrier.apply(reach).mean(axis=0)
            here = carrier * here
        vectors[:, joint] = here.as_rotvec()
    angles = unwrapped(vectors).reshape(len(motion), -1)[:, table.places]
    return AngleSequence(np.hstack([positions[:, found[0]], angles]), table, offsets)


def load_angles(
    path: str | Path, mapping: dict[str, str] | None = None, unit: float | None = None
) -> AngleSequence:
    """`angles_of` any motion file.

    Raises
    ------
    MotionFileError
        If the file cannot be read.
    UnknownRigError
        With the file's name, if joints are missing.
    """
    try:
        return angles_of(load_motion(path, unit=unit), mapping)
    except UnknownRigError as error:
        raise UnknownRigError(f"{path}: {error}") from None


def motion_of(numbers: np.ndarray, table: AngleTable, offsets: np.ndarray) -> Motion:
    """The motion that 54 numbers a frame describe, on bones of our own.

    Parameters
    ----------
    numbers : (F, 54) array of float
    table : AngleTable
    offsets : (J, 3) array of float
        As in `AngleSequence`.

    Returns
    -------
    Motion
        At 25 frames a second. The root is where the translation says; see `on_floor` for a clip.
    """
    frames, joints = len(numbers), len(table.joints)
    vectors = np.zeros((frames, 3 * joints))
    vectors[:, table.places] = numbers[:, TRANSLATION.stop :]
    # A joint that does not turn moves with its parent: the offset from its carrier is what is left.
    local = np.array(offsets, dtype=np.float64)
    for joint, (parent, carrier) in enumerate(zip(table.parents, table.carriers, strict=True)):
        if parent != carrier:
            local[joint] -= offsets[parent]
    translations = np.tile(local, (frames, 1, 1))
    translations[:, 0] = numbers[:, TRANSLATION]
    rotations = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_quat().reshape(frames, joints, 4)
    skeleton = Skeleton(table.joints, table.parents, local)
    return Motion(skeleton, ANGLE_RATE, rotations, translations)


def on_floor(motion: Motion) -> Motion:
    """The same motion moved up or down so that its lowest joint ever touches the floor: a clip's
    translation is relative to its first frame, and how high that was is not known."""
    translations = motion.translations.copy()
    translations[:, 0, 1] -= motion.positions()[..., 1].min()
    return Motion(motion.skeleton, motion.rate, motion.rotations, translations)
