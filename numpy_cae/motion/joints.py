"""The twenty joints of holden2015, section 4.

The paper uses "the joint positions of 20 of the most important joints" and does not list them.
These are four along the spine and four for each limb. There is no neck: its position follows from
chest and head, and half of the rigs have two.

`joints.json` has for each joint its parent, its direction from the parent in a T-pose and, at the
end of a limb, the tip of the bone in metres from the joint.
"""

import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np

_FILE = Path(__file__).with_suffix(".json").read_text(encoding="utf-8")
_BODY: dict[str, list] = json.loads(_FILE)
JOINTS: tuple[str, ...] = tuple(_BODY)
"""The names of the twenty joints: hips, spine, chest, head, and four for each limb."""
PARENTS: tuple[int, ...] = tuple(
    -1 if parent is None else JOINTS.index(parent) for parent, *_ in _BODY.values()
)
"""For each of `JOINTS` the index of its parent, -1 for the hips."""
REST_DIRECTIONS: np.ndarray = np.array([row[1] for row in _BODY.values()])
"""The direction of the bone that ends at each joint, in a T-pose that faces +Z, Y up."""
REST_TIPS = {joint: np.array(row[2]) for joint, row in enumerate(_BODY.values()) if row[2:]}
"""For the index of each joint at which no other begins, the tip of its bone in metres from the
joint."""

SIDES = ("left", "right")
LIMBS: dict[str, tuple[str, ...]] = {
    "left_arm": ("left_elbow", "left_wrist"),
    "right_arm": ("right_elbow", "right_wrist"),
    "left_leg": ("left_knee", "left_ankle", "left_toe"),
    "right_leg": ("right_knee", "right_ankle", "right_toe"),
}
"""The joints that move where a shoulder or a hip turns."""


def joint_mask(frames: int, joints: Iterable[str], among: slice | np.ndarray) -> np.ndarray:
    """(frames, 20) bool: True for some joints, by name, in the frames `among`."""
    mask = np.zeros((frames, len(JOINTS)), bool)
    for joint in joints:
        mask[among, JOINTS.index(joint)] = True
    return mask
