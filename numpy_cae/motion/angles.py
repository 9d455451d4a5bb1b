"""A motion as the 54 numbers a frame of jang2018, and back.

A joint's rotation is relative to its nearest ancestor in the table, so that the rotations of the
joints between (a second bone of the spine, a collar) are included and every joint of the table
keeps its orientation:

    R_j = G_ancestorᵀ · G_j
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from numpy_cae.motion import quaternions
from numpy_cae.motion.angle_table import TRANSLATION, AngleTable, table_for
from numpy_cae.motion.io.coordinates import Coordinates
from numpy_cae.motion.io.load import load_motion
from numpy_cae.motion.io.t_pose import without_t_pose
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import Mappings, UnknownRigError
from numpy_cae.motion.skeleton import Skeleton
from numpy_cae.motion.unwrap import unwrapped

ANGLE_RATE = 25.0
"""Frames a second, MBR17's rate for Human3.6M: half of its fifty."""


@dataclass(frozen=True)
class AngleSequence:
    """A motion in joint space.

    Parameters
    ----------
    numbers : (F, 54) array of float64
        The root's position in metres and 51 angles in radians, unwrapped in time, in the order of
        `table.columns`.
    table : AngleTable
    offsets : (J, 3) array of float64
        From each joint's nearest rotating ancestor to the joint in metres, mean over the motion.
    """

    numbers: np.ndarray
    table: AngleTable
    offsets: np.ndarray

    def __len__(self) -> int:
        return len(self.numbers)


def angles_of(motion: Motion, mapping: Mappings = None) -> AngleSequence:
    """The motion at 25 frames a second, without a leading T-pose, as 54 numbers a frame.

    Parameters
    ----------
    motion : Motion
        At the rate of its file.
    mapping : dict, optional
        See `find_joints`.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    table = table_for(motion.skeleton)
    found = table.find(motion.skeleton, mapping)
    motion = without_t_pose(motion, mapping).resampled(ANGLE_RATE)
    positions, rotations = motion.forward_kinematics()
    vectors = np.zeros((len(motion), len(found), 3))
    offsets = np.zeros((len(found), 3))
    for joint, ancestor in enumerate(table.rotating_parents):
        local = rotations[:, found[joint]]
        if ancestor >= 0:
            inverse = quaternions.inverse(rotations[:, found[ancestor]])
            offset = positions[:, found[joint]] - positions[:, found[ancestor]]
            offsets[joint] = quaternions.rotate(inverse, offset).mean(axis=0)
            local = quaternions.product(inverse, local)
        vectors[:, joint] = quaternions.to_vector(local)
    angles = unwrapped(vectors).reshape(len(motion), -1)[:, table.indices]
    return AngleSequence(np.hstack([positions[:, found[0]], angles]), table, offsets)


def load_angles(
    path: str | Path, mapping: Mappings = None, coordinates: Coordinates | None = None
) -> AngleSequence:
    """`angles_of` any motion file. A floor is not looked for: clips are relative to their start.

    Raises MotionFileError if the file cannot be read; UnknownRigError, with the name of the file,
    if joints are missing.
    """
    try:
        known = vars(coordinates or Coordinates())
        return angles_of(load_motion(path, mapping=mapping, **known | {"floor": 0.0}), mapping)
    except UnknownRigError as error:
        raise UnknownRigError(f"{path}: {error}") from None


def motion_of(numbers: np.ndarray, table: AngleTable, offsets: np.ndarray) -> Motion:
    """The motion, at 25 frames a second, that 54 numbers a frame describe.

    Parameters
    ----------
    numbers : (F, 54) array of float
        The root is at their translation; see `on_floor` for a clip.
    table : AngleTable
    offsets : (J, 3) array of float
        Of the bones, as in `AngleSequence`.
    """
    frames, joints = len(numbers), len(table.joints)
    vectors = np.zeros((frames, 3 * joints))
    vectors[:, table.indices] = numbers[:, TRANSLATION.stop :]
    # A joint whose parent does not rotate: subtract the parent's offset from the same ancestor.
    local = np.array(offsets, dtype=np.float64)
    for joint, parent in enumerate(table.parents):
        if parent != table.rotating_parents[joint]:
            local[joint] -= offsets[parent]
    translations = np.tile(local, (frames, 1, 1))
    translations[:, 0] = numbers[:, TRANSLATION]
    rotations = quaternions.from_vector(vectors.reshape(frames, joints, 3))
    skeleton = Skeleton(table.joints, table.parents, local)
    return Motion(skeleton, ANGLE_RATE, rotations, translations)


def on_floor(motion: Motion) -> Motion:
    """The motion moved vertically so that its lowest joint touches the floor once: a clip's
    translation is relative to its first frame, whose height is unknown."""
    translations = motion.translations.copy()
    translations[:, 0, 1] -= motion.positions()[..., 1].min()
    return replace(motion, translations=translations)
