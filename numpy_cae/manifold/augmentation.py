"""Mirrored copies of takes, and the chains of joints that training damages.

Neither is in the paper, which learns from a larger database.
"""

import numpy as np

from numpy_cae.motion import JOINTS, PARENTS, joint_slice

_SIDES = {"left": "right", "right": "left"}
_MIRRORED = [
    JOINTS.index("_".join(_SIDES.get(part, part) for part in joint.split("_"))) for joint in JOINTS
]
_LIMBS = [("chest", "shoulder", "elbow", "wrist"), ("hips", "knee", "ankle", "toe")]


def mirrored(positions: np.ndarray) -> np.ndarray:
    """World positions (F, 20, 3) with left and right exchanged."""
    return positions[:, _MIRRORED] * [-1.0, 1.0, 1.0]


def damaged_chains() -> tuple[tuple[int, ...], ...]:
    """The chains of joints for `training.corruption.damage_stretches`, as indices of the features.

    Every joint is a chain with its parent as base. Each limb gives four more chains, so that whole
    limbs are drawn often enough: one with the chest or the hips as base and one with the limb's
    first joint as base, each of them twice.
    """
    chains: list[tuple[int, ...]] = [(PARENTS[joint], joint) for joint in range(1, len(JOINTS))]
    for side in _SIDES:
        for base, *limb in _LIMBS:
            points = [JOINTS.index(f"{side}_{joint}") for joint in limb]
            chains += 2 * [(JOINTS.index(base), *points), tuple(points)]
    return tuple(tuple(joint_slice(JOINTS[j]).start for j in chain) for chain in chains)
