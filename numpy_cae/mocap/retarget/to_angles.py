"""Convert a motion of any rig to the 54 numbers for each frame of jang2018.

A joint's rotation is relative to its nearest ancestor in the table. It includes the rotations of
the joints in between (a second bone of the spine, a collar), so that every joint of the table keeps
its orientation:

    R_j = G_ancestorᵀ · G_j

Conversions of the CMU database insert a T-pose before the first frame. It is not part of the
motion, and the next frame, a 120th of a second later, is another pose. So the T-pose is recognised
by its shape and by the jump after it. Someone recorded in a T-pose leaves it slowly; that T-pose is
not removed.
"""

import numpy as np

from numpy_cae.mocap.formats.expmap_rigs import HUMAN36M
from numpy_cae.mocap.retarget.body import body_positions
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import quaternions
from numpy_cae.motion.angle_table import HUMAN36M_TABLE, SEVENTEEN, AngleTable
from numpy_cae.motion.angles import ANGLE_RATE, AngleSequence, unwrapped
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion

MIN_COSINE = np.cos(np.radians(20.0))
"""MIN_COSINE: a limb is in a T-pose if the angle to its direction there has this cosine or more."""
JUMP = 8.0
"""JUMP: the first step is a jump if it exceeds this multiple of the median of the next steps."""
_FOLLOWING = 25

# limb, from, to, and its direction in a T-pose that faces +Z
_LIMBS = (
    ("left_shoulder", "left_wrist", (1.0, 0.0, 0.0)),
    ("right_shoulder", "right_wrist", (-1.0, 0.0, 0.0)),
    ("left_hip", "left_ankle", (0.0, -1.0, 0.0)),
    ("right_hip", "right_ankle", (0.0, -1.0, 0.0)),
)


def angles_of(motion: Motion) -> AngleSequence:
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
    table = HUMAN36M_TABLE if is_human36m else SEVENTEEN
    found = joints_in(table, motion)
    motion = without_t_pose(motion).resampled(ANGLE_RATE)
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


def joints_in(table: AngleTable, motion: Motion) -> list[int]:
    """The indices of the joints of a table in a motion; UnknownRigError if any is missing."""
    if table is HUMAN36M_TABLE:
        return [motion.skeleton.index(joint) for joint in table.joints]
    found = rig_of(motion).found
    # The neck is the first joint on the way from the chest to the head, whatever its name. In rigs
    # without a neck it is the head: the table's neck then has the whole rotation, its head none.
    neck = found["head"]
    while motion.skeleton.parents[neck] not in (found["chest"], -1):
        neck = motion.skeleton.parents[neck]
    found = found | {"neck": neck}
    return [found[joint] for joint in table.joints]


def without_t_pose(motion: Motion) -> Motion:
    """The motion without its first frame, if this is a T-pose that is followed by a jump.

    Parameters
    ----------
    motion : Motion
        At the rate of its file: resampling would blend the T-pose with the next frames.

    Returns
    -------
    Motion
        The same object if its first frame is not such a T-pose.

    Raises
    ------
    UnknownRigError
        If joints are missing.

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 1, seconds=1.0).motion
    >>> without_t_pose(walk) is walk
    True
    """
    if len(motion) < 3:
        return motion
    body = body_positions(motion.at(slice(0, 1)))[0]
    for start, end, direction in _LIMBS:
        limb = body[JOINTS.index(end)] - body[JOINTS.index(start)]
        if limb @ np.array(direction) < MIN_COSINE * np.linalg.norm(limb):
            return motion
    first = motion.rotations[: _FOLLOWING + 2]
    steps = np.linalg.norm(
        quaternions.angle(quaternions.product(first[1:], quaternions.inverse(first[:-1]))), axis=-1
    )
    jumps = steps[0] > JUMP * max(float(np.median(steps[1:])), 1e-3)
    return motion.at(slice(1, None)) if jumps else motion
