"""Suggest which joints of an unknown rig are the twenty, from its hierarchy and rest pose.

A person has two pairs of limbs that are mirror images: the legs begin at the hips, the arms at the
chest, on another branch. The longest such pairs are taken. Knees and elbows divide a limb into two
long bones.
"""

import re
from itertools import combinations, pairwise, product

import numpy as np

from numpy_cae.mocap.rigs.checks import left_or_right
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.skeleton import Skeleton

_MAX_JOINTS, _MAX_PAIRS = 1000, 50
_SAME = 0.15
"""_SAME: a left and a right limb differ in length by at most this part of the longer one."""
_LONG = 0.75
"""_LONG: consider the shorter of the two bones at each joint of a limb. At a knee or elbow it is at
least this part of the longest of these."""
_HEAD = 0.06
"""_HEAD: the head joint is below the top of the head by at least this part of the longest path from
the root to a tip."""
_NOT_A_JOINT = re.compile(r"twist|roll|[._]0\d\d$", re.IGNORECASE)
"""_NOT_A_JOINT: names of joints that divide one bone."""

_Pair = tuple[int, int, int]
"""The joint that carries a pair of limbs, and the first joint of each."""


def suggest_mapping(skeleton: Skeleton) -> dict[str, str]:
    """A mapping of our joint names to those of an unknown rig, from its hierarchy and rest pose.

    Joints that the rig seems to lack are left out. If nothing looks like a person, it is empty.
    """
    if len(skeleton.names) > _MAX_JOINTS:
        return {}
    chains, reach = _chains(skeleton)
    best, found = 0.0, {}
    legs = arms = (0, 0, 0)
    for leg, arm in product(_pairs(skeleton, reach), repeat=2):
        arm_path, leg_path = skeleton.path(arm[0]), skeleton.path(leg[0])
        hips = next(joint for joint in leg_path if joint in arm_path)
        length = reach[leg[1]] + reach[arm[1]] - _length(skeleton, leg_path[: leg_path.index(hips)])
        if hips != arm[0] and not set(leg[1:]) & set(arm_path) and length > best:
            best, legs, arms, found = length, leg, arm, {"hips": hips, "chest": arm[0]}
    if not found:
        return {}
    limbs = {start: _limb(skeleton, chains[start]) for start in (*legs[1:], *arms[1:])}
    places = skeleton.rest_positions()
    feet = [limbs[start][3:] for start in legs[1:] if None not in limbs[start][3:]]
    forward = sum((places[toe] - places[ankle] for ankle, toe in feet), np.zeros(3))
    left = np.cross(places[found["chest"]] - places[found["hips"]], forward)
    for names, (_, *starts) in (
        ("- hip knee ankle toe", legs),
        ("collar shoulder elbow wrist -", arms),
    ):
        for side, start in zip(
            ("left", "right"), _left_first(skeleton, starts, places @ left), strict=True
        ):
            for name, joint in zip(names.split(), limbs[start], strict=True):
                if name != "-" and joint is not None:
                    found[f"{side}_{name}"] = joint
    necks = [chains[child] for child in skeleton.children(arms[0]) if child not in arms]
    if necks:
        found["head"] = _head(skeleton, necks, reach)
    add_trunk(skeleton, found, {"hips", "chest"})
    return {joint: skeleton.names[found[joint]] for joint in JOINTS if joint in found}


def add_trunk(skeleton: Skeleton, found: dict[str, int], named: set[str]) -> None:
    """Find chest and spine by hierarchy if they are missing or the collars begin above the chest.

    The joints that the user `named` are not changed.
    """
    arms = next((f"{{}}_{arm}" for arm in ("collar", "shoulder") if f"left_{arm}" in found), None)
    if arms is None or arms.format("right") not in found or "hips" not in found:
        return
    left, right = (skeleton.path(found[arms.format(side)]) for side in ("left", "right"))
    carrier = next((joint for joint in left[1:] if joint in right[1:]), -1)
    ancestors = skeleton.path(carrier)[1:] if carrier >= 0 else []
    if "chest" not in named and found.get("chest", found["hips"]) in ancestors:
        found["chest"] = carrier
        if "spine" not in named:
            found.pop("spine", None)
    if {"chest", "spine"} & (named | set(found)) != {"chest"} or found["hips"] not in ancestors:
        return
    between = ancestors[: ancestors.index(found["hips"])]
    if between:
        lengths = np.linalg.norm(skeleton.offsets, axis=-1)
        # Distance from the chest down to each joint in between, and to the hips.
        down = np.cumsum(lengths[[carrier, *between]])
        found["spine"] = between[int(np.argmin(np.abs(down[:-1] - down[-1] / 2)))]


def _length(skeleton: Skeleton, joints: list[int]) -> float:
    """The total length of the bones that end at these joints."""
    return float(np.linalg.norm(skeleton.offsets[joints], axis=-1).sum())


def _chains(skeleton: Skeleton) -> tuple[list[list[int]], list[float]]:
    """The longest path down from each joint to a tip, and its length."""
    chains = [[joint] for joint in range(len(skeleton.names))]
    reach = [float(np.linalg.norm(skeleton.end_sites.get(joint, 0.0))) for (joint,) in chains]
    for joint in range(len(chains) - 1, 0, -1):
        parent, length = skeleton.parents[joint], reach[joint] + _length(skeleton, [joint])
        if length >= reach[parent]:
            chains[parent], reach[parent] = [parent, *chains[joint]], length
    return chains, reach


def _pairs(skeleton: Skeleton, reach: list[float]) -> list[_Pair]:
    """The longest pairs of branches at a joint that are not tiny and of nearly the same length."""
    least = 0.1 * max(reach)
    pairs = [
        (joint, one, other)
        for joint in range(len(reach))
        for one, other in combinations(
            [child for child in skeleton.children(joint) if reach[child] > least], 2
        )
        if abs(reach[one] - reach[other]) <= _SAME * max(reach[one], reach[other])
    ]
    return sorted(pairs, key=lambda pair: -reach[pair[1]] - reach[pair[2]])[:_MAX_PAIRS]


def _limb(skeleton: Skeleton, chain: list[int]) -> tuple[int | None, ...]:
    """The joint before a limb, its three joints and the next one, each None if there is none.

    They are collar, shoulder, elbow and wrist of an arm, or (after a None or another joint) hip,
    knee, ankle and toe of a leg.
    """
    joints = [joint for joint in chain if not _NOT_A_JOINT.search(skeleton.names[joint])]
    if len(joints) < 3:
        return (None,) * 5
    ends = [chain.index(joint) for joint in joints]
    bones = [_length(skeleton, chain[start + 1 : end + 1]) for start, end in pairwise(ends)]
    # The last pair of adjacent long bones, as a collar may be as long as a forearm.
    shorter = np.minimum(bones[:-1], bones[1:])
    first = int(np.flatnonzero(shorter >= _LONG * shorter.max())[-1])
    return tuple([None, *joints, None][first : first + 5])


def _head(skeleton: Skeleton, necks: list[list[int]], reach: list[float]) -> int:
    """In the longest branch the first joint whose name contains "head", or else the last joint that
    is not close to the tip: at `_HEAD` of the longest reach or more."""
    neck = max(necks, key=lambda chain: reach[chain[0]] + len(chain))
    named = [joint for joint in neck if "head" in skeleton.names[joint].lower()]
    high = [joint for joint in neck if reach[joint] >= _HEAD * max(reach)]
    return named[0] if named else (high or neck)[-1]


def _left_first(skeleton: Skeleton, starts: list[int], leftness: np.ndarray) -> list[int]:
    """The first joints of two limbs, the left one first; their names or the rest pose decide."""
    side = left_or_right(*(skeleton.names[start] for start in starts))
    if side:
        return starts if side == "left" else starts[::-1]
    return sorted(starts, key=lambda start: -leftness[start])
