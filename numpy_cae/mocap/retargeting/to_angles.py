"""Convert a motion of any rig to the 54 numbers for each frame of jang2018.

A joint's rotation is relative to its nearest ancestor in the table. It includes the rotations of
the joints in between (a second bone of the spine, a collar), so that every joint of the table keeps
its orientation:

    R_j = G_ancestorᵀ · G_j
"""

import numpy as np

from numpy_cae.mocap.formats.expmap import HUMAN36M
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.mocap.t_pose import leading_t_pose
from numpy_cae.motion import Motion, angles, quaternions


def angles_of(motion: Motion) -> angles.AngleSequence:
    """A motion as 54 numbers for each frame, at 25 frames a second and without a leading T-pose.

    Parameters
    ----------
    motion : Motion
        At the rate of its file.

    Returns
    -------
    AngleSequence

    Raises
    ------
    UnknownRigError
        If joints are missing.

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = angles_of(make_take("walk", 1, seconds=2.0, rate=120.0).motion)
    >>> walk.numbers.shape  # two seconds at 25 frames a second
    (50, 54)
    """
    # Human3.6M's own table for its text, seventeen joints for every other rig.
    is_human36m = motion.skeleton.names == HUMAN36M.skeleton.names
    table = angles.HUMAN36M_TABLE if is_human36m else angles.SEVENTEEN
    joints = joints_in(table, motion)
    pose = leading_t_pose(motion)
    motion = motion.at(slice(pose.frames, None)) if pose else motion
    motion = motion.resampled(angles.ANGLE_RATE)
    positions, rotations = motion.forward_kinematics()
    vectors = np.zeros((len(motion), len(joints), 3))
    offsets = np.zeros((len(joints), 3))
    for joint, ancestor in enumerate(table.rotating_parents):
        local = rotations[:, joints[joint]]
        if ancestor >= 0:
            inverse = quaternions.inverse(rotations[:, joints[ancestor]])
            offset = positions[:, joints[joint]] - positions[:, joints[ancestor]]
            offsets[joint] = quaternions.rotate(inverse, offset).mean(axis=0)
            local = quaternions.product(inverse, local)
        vectors[:, joint] = quaternions.to_vector(local)
    turned = angles.unwrap(vectors).reshape(len(motion), -1)[:, table.indices]
    return angles.AngleSequence(np.hstack([positions[:, joints[0]], turned]), table, offsets)


def joints_in(table: angles.AngleTable, motion: Motion) -> list[int]:
    """The indices of the joints of a table in a motion; UnknownRigError if any is missing."""
    if table is angles.HUMAN36M_TABLE:
        return [motion.skeleton.index(joint) for joint in table.joints]
    indices = rig_of(motion).indices
    # The neck is the first joint on the way from the chest to the head, whatever its name. In rigs
    # without a neck it is the head: the table's neck then has the whole rotation, its head none.
    neck = indices["head"]
    while motion.skeleton.parents[neck] not in (indices["chest"], -1):
        neck = motion.skeleton.parents[neck]
    indices = indices | {"neck": neck}
    return [indices[joint] for joint in table.joints]
