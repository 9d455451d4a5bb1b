"""The twenty joints of holden2015, section 4.

The paper uses "the joint positions of 20 of the most important joints" and does not list them.
These are four along the spine and four for each limb. There is no neck: its position follows from
chest and head, and half of the rigs have two.
"""

from collections.abc import Iterable

import numpy as np

# joint: (parent, direction of the bone in a T-pose that faces +Z, Y up)
_BODY = {
    "hips": (None, (0.0, 0.0, 0.0)),
    "spine": ("hips", (0.0, 1.0, 0.0)),
    "chest": ("spine", (0.0, 1.0, 0.0)),
    "head": ("chest", (0.0, 1.0, 0.0)),
    "left_collar": ("chest", (0.35, 0.94, 0.0)),
    "left_shoulder": ("left_collar", (1.0, 0.0, 0.0)),
    "left_elbow": ("left_shoulder", (1.0, 0.0, 0.0)),
    "left_wrist": ("left_elbow", (1.0, 0.0, 0.0)),
    "right_collar": ("chest", (-0.35, 0.94, 0.0)),
    "right_shoulder": ("right_collar", (-1.0, 0.0, 0.0)),
    "right_elbow": ("right_shoulder", (-1.0, 0.0, 0.0)),
    "right_wrist": ("right_elbow", (-1.0, 0.0, 0.0)),
    "left_hip": ("hips", (0.77, -0.64, 0.0)),
    "left_knee": ("left_hip", (0.0, -1.0, 0.0)),
    "left_ankle": ("left_knee", (0.0, -1.0, 0.0)),
    "left_toe": ("left_ankle", (0.0, -0.5, 0.87)),
    "right_hip": ("hips", (-0.77, -0.64, 0.0)),
    "right_knee": ("right_hip", (0.0, -1.0, 0.0)),
    "right_ankle": ("right_knee", (0.0, -1.0, 0.0)),
    "right_toe": ("right_ankle", (0.0, -0.5, 0.87)),
}

JOINTS: tuple[str, ...] = tuple(_BODY)
PARENTS: tuple[int, ...] = tuple(
    -1 if parent is None else JOINTS.index(parent) for parent, _ in _BODY.values()
)
REST_DIRECTIONS: np.ndarray = np.array([direction for _, direction in _BODY.values()])

LIMBS: dict[str, tuple[str, ...]] = {
    f"{side}_{limb}": tuple(f"{side}_{joint}" for joint in joints)
    for limb, joints in (("arm", ("elbow", "wrist")), ("leg", ("knee", "ankle", "toe")))
    for side in ("left", "right")
}
"""The joints that move where a shoulder or a hip turns."""


def joint_mask(frames: int, joints: Iterable[str], among: slice | np.ndarray) -> np.ndarray:
    """(frames, 20) bool: True for some joints, by name, in the frames `among`."""
    mask = np.zeros((frames, len(JOINTS)), bool)
    for joint in joints:
        mask[among, JOINTS.index(joint)] = True
    return mask
