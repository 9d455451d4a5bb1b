"""Reasons to doubt which joints of a rig are the twenty, if its hierarchy suggests them.

A suggestion is used without a question only if its joints are in order along each limb, names and
places agree on left and right, and the bones and the pose are a person's.
"""

import numpy as np

from numpy_cae.mocap.rigs.rigs import Rig
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.lengths import frame_lengths
from numpy_cae.motion.motion import Skeleton

UNEQUAL = 1.5
"""UNEQUAL: the bones of a left and a right limb differ by at most this factor. A program that
estimates a pose from one video frame gives them different lengths."""
RATIOS = {
    "thigh to shin": ("knee", "ankle", 0.6, 1.7),
    "upper arm to forearm": ("elbow", "wrist", 0.6, 2.2),
    "thigh to upper arm": ("knee", "elbow", 1.0, 2.3),
    "shin to forearm": ("ankle", "wrist", 1.0, 2.8),
    "trunk to thigh": ("trunk", "knee", 0.3, 1.8),
}
"""RATIOS: the smallest and largest ratio of the lengths of two bones, which are named by the joints
where they end; the trunk ends at the chest and begins at the hips. In the files of five sources
the ratios are 0.9 to 1.3, 1.0 to 1.7, 1.4 to 1.7, 1.5 to 2.1 and 0.5 to 0.8."""


def left_or_right(one: str, other: str) -> str:
    """The side of joint `one` by its name and that of the same joint on the other side, such as
    "lShldr" and "rShldr": "left" or "right", or "" if the names do not tell."""
    pairs = zip(one.lower(), other.lower(), strict=False)
    differing = next((a + b for a, b in pairs if a != b), "")
    return {"lr": "left", "rl": "right"}.get(differing, "")


def order_problem(skeleton: Skeleton, rig: Rig) -> str:
    """Which of the twenty joints does not descend from its parent in the rig, or from the next one
    if the file lacks the parent; empty if all do."""
    joints = rig.joints
    for joint, parent in list(enumerate(PARENTS))[1:]:
        while joints[parent] in rig.added:
            parent = PARENTS[parent]
        if joints[parent] not in skeleton.path(joints[joint])[1:]:
            return f"{JOINTS[joint]} is not below {JOINTS[parent]}"
    return ""


def doubt(skeleton: Skeleton, rig: Rig, poses: np.ndarray) -> str:
    """Why a rig's twenty joints may not be these; empty if there is no reason.

    `poses` (N, 20, 3) are positions of the joints in the rest pose, then in some frames.
    """
    at = {joint: poses[:, index] for index, joint in enumerate(JOINTS)}
    return (
        order_problem(skeleton, rig)
        or _side_problem(skeleton, rig, at)
        or _length_problem(at, np.median(frame_lengths(poses), axis=0))
        or ("" if _mostly(_stands(at)) else "neither the rest pose nor most others are upright")
    )


def _mostly(in_pose: np.ndarray) -> bool:
    """Whether something is so in the rest pose, which is the first one, or in most other poses."""
    return bool(in_pose[0] or np.mean(in_pose[1:]) > 0.5)


def _side_problem(skeleton: Skeleton, rig: Rig, at: dict[str, np.ndarray]) -> str:
    across = at["left_hip"] - at["right_hip"]
    shoulders = at["left_shoulder"] - at["right_shoulder"]
    if not _mostly(np.sum(across * shoulders, axis=-1) > 0):
        return "an arm and a leg of one side are on different sides"
    name = {our: skeleton.names[joint] for our, joint in rig.found.items()}
    own = [our for our in JOINTS if rig.found[our] not in rig.added]
    lefts = [our for our in own if our.startswith("left")]
    sides = [left_or_right(name[our], name[our.replace("left", "right")]) for our in lefts]
    if "right" in sides:
        return f"{name[lefts[sides.index('right')]]} does not sound like the left side"
    if "" not in sides:
        return ""
    if "left_toe" not in own:
        return "neither names nor toes tell left from right"
    forward = at["left_toe"] - at["left_ankle"] + at["right_toe"] - at["right_ankle"]
    left = np.cross(at["chest"] - at["hips"], forward)
    if not _mostly(np.sum(left * across, axis=-1) > 0):
        return "the toes point backwards"
    return ""


def _length_problem(at: dict[str, np.ndarray], lengths: np.ndarray) -> str:
    length = dict(zip(JOINTS, lengths.tolist(), strict=True))
    trunk = np.linalg.norm(at["chest"] - at["hips"], axis=-1)
    mean = {"trunk": float(np.median(trunk))}
    for joint in ("elbow", "wrist", "knee", "ankle"):
        left, right = length[f"left_{joint}"], length[f"right_{joint}"]
        if not max(left, right) <= UNEQUAL * min(left, right):
            return f"the bones to left_{joint} and right_{joint} are not equally long"
        mean[joint] = (left + right) / 2
    for bones, (one, other, least, most) in RATIOS.items():
        ratio = mean[one] / max(mean[other], 1e-9)
        if not least <= ratio <= most:
            return f"the ratio of {bones} is {ratio:.2g}, a person's is {least:g} to {most:g}"
    return ""


def _stands(at: dict[str, np.ndarray]) -> np.ndarray:
    """Whether, along the line from hips to chest, the ankles are below the hips and the head is
    above the chest, (N,)."""
    trunk = at["chest"] - at["hips"]
    ankles = (at["left_ankle"] + at["right_ankle"]) / 2 - at["hips"]
    head = at["head"] - at["chest"]
    return (np.sum(ankles * trunk, axis=-1) < 0) & (np.sum(head * trunk, axis=-1) > 0)
