"""Suggest which joints of an unknown rig are the twenty, from its hierarchy and rest pose.

A person has two pairs of limbs that are mirror images: the legs begin at the hips, the arms at the
chest, on another branch. The longest such pairs are taken. Knees and elbows divide a limb into two
long bones.
"""

import re
from collections.abc import Sequence
from itertools import combinations, pairwise, product

import numpy as np

from numpy_cae.mocap.rigs.rigs import add_trunk, left_or_right
from numpy_cae.motion import JOINTS, Skeleton
from numpy_cae.motion.joints import SIDES

_MAX_JOINTS = 1000
"""Nothing is suggested for a skeleton with more joints."""
_MAX_PAIRS = 50
"""At most this many pairs of limbs, the longest, are compared."""
_TINY_SHARE = 0.1
"""A limb is longer than this part of the longest path from the root to a tip."""
_SAME_SHARE = 0.15
"""A left and a right limb differ in length by at most this part of the longer one."""
_LONG_SHARE = 0.75
"""Consider the shorter of the two bones at each joint of a limb. At a knee or elbow it is at least
this part of the longest of these."""
_HEAD_SHARE = 0.06
"""The head joint is below the top of the head by at least this part of the longest path from the
root to a tip."""
_NOT_A_JOINT = re.compile(r"twist|roll|[._]0\d\d$", re.IGNORECASE)
"""Names of joints that divide one bone."""

_LEG = ("", "hip", "knee", "ankle", "toe")
_ARM = ("collar", "shoulder", "elbow", "wrist", "")
"""Our names of the joints that `_limb` returns."""
_Limb = tuple[int | None, ...]
"""What `_limb` returns: five joints, or None where there is none."""
_Pair = tuple[int, int, int]
"""The joint that carries a pair of limbs, and the first joint of each."""


def suggest_mapping(skeleton: Skeleton) -> dict[str, str]:
    """A mapping of our joint names to those of an unknown rig, from its hierarchy and rest pose.

    Joints that the rig seems to lack are left out. If nothing looks like a person, it is empty.
    """
    if len(skeleton.names) > _MAX_JOINTS:
        return {}
    chains, reach = _chains(skeleton)
    pairs = _legs_and_arms(skeleton, reach)
    if pairs is None:
        return {}
    legs, arms = pairs
    indices = {"hips": _meeting_joint(skeleton, legs[0], arms[0]), "chest": arms[0]}
    limbs = {start: _limb(skeleton, chains[start]) for start in (*legs[1:], *arms[1:])}
    leftness = _leftness(skeleton, [limbs[start] for start in legs[1:]], indices)
    for names, pair in ((_LEG, legs), (_ARM, arms)):
        starts = _left_first(skeleton, pair[1:], leftness)
        for side, start in zip(SIDES, starts, strict=True):
            indices |= _name_limb(side, names, limbs[start])
    necks = [chains[child] for child in skeleton.children(arms[0]) if child not in arms]
    if necks:
        indices["head"] = _head(skeleton, necks, reach)
    add_trunk(skeleton, indices, {"hips", "chest"})
    return {joint: skeleton.names[indices[joint]] for joint in JOINTS if joint in indices}


def _name_limb(side: str, names: Sequence[str], limb: _Limb) -> dict[str, int]:
    """The joints of a limb that has them, by our names."""
    indices = {}
    for name, joint in zip(names, limb, strict=True):
        if name and joint is not None:
            indices[f"{side}_{name}"] = joint
    return indices


def _leftness(skeleton: Skeleton, legs: list[_Limb], indices: dict[str, int]) -> np.ndarray:
    """How far each joint is to the left in the rest pose, (J,), where toes tell the front."""
    places = skeleton.rest_positions()
    forward = np.zeros(3)
    for *_, ankle, toe in legs:
        if ankle and toe:
            forward += places[toe] - places[ankle]
    trunk = places[indices["chest"]] - places[indices["hips"]]
    return places @ np.cross(trunk, forward)


def _legs_and_arms(skeleton: Skeleton, reach: list[float]) -> tuple[_Pair, _Pair] | None:
    """The two longest pairs of limbs of which the second begins on another branch than the first;
    None if there are none."""
    longest = 0.0
    longest_pairs = None
    for legs, arms in product(_pairs(skeleton, reach), repeat=2):
        hips = _meeting_joint(skeleton, legs[0], arms[0])
        path = skeleton.path(legs[0])
        length = reach[legs[1]] + reach[arms[1]] - _length(skeleton, path[: path.index(hips)])
        on_other_branch = hips != arms[0] and not set(legs[1:]) & set(skeleton.path(arms[0]))
        if on_other_branch and length > longest:
            longest = length
            longest_pairs = (legs, arms)
    return longest_pairs


def _meeting_joint(skeleton: Skeleton, first: int, second: int) -> int:
    """The joint at which the ways from two joints to the root meet."""
    path = skeleton.path(second)
    return next(joint for joint in skeleton.path(first) if joint in path)


def _length(skeleton: Skeleton, joints: list[int]) -> float:
    """The total length of the bones that end at these joints."""
    return float(np.linalg.norm(skeleton.offsets[joints], axis=-1).sum())


def _chains(skeleton: Skeleton) -> tuple[list[list[int]], list[float]]:
    """The longest path down from each joint to a tip, and its length."""
    chains = [[joint] for joint in range(len(skeleton.names))]
    reach = [float(np.linalg.norm(skeleton.end_sites.get(joint, 0.0))) for (joint,) in chains]
    for joint in range(len(chains) - 1, 0, -1):
        parent = skeleton.parents[joint]
        length = reach[joint] + _length(skeleton, [joint])
        if length >= reach[parent]:
            chains[parent] = [parent, *chains[joint]]
            reach[parent] = length
    return chains, reach


def _pairs(skeleton: Skeleton, reach: list[float]) -> list[_Pair]:
    """The longest pairs of branches at a joint that are not tiny and of nearly the same length."""
    least = _TINY_SHARE * max(reach)
    pairs = []
    for joint in range(len(reach)):
        long = [child for child in skeleton.children(joint) if reach[child] > least]
        for first, second in combinations(long, 2):
            longer = max(reach[first], reach[second])
            if abs(reach[first] - reach[second]) <= _SAME_SHARE * longer:
                pairs.append((joint, first, second))
    return sorted(pairs, key=lambda pair: -reach[pair[1]] - reach[pair[2]])[:_MAX_PAIRS]


def _limb(skeleton: Skeleton, chain: list[int]) -> _Limb:
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
    first = int(np.flatnonzero(shorter >= _LONG_SHARE * shorter.max())[-1])
    return tuple([None, *joints, None][first : first + 5])


def _head(skeleton: Skeleton, necks: list[list[int]], reach: list[float]) -> int:
    """In the longest branch the first joint whose name contains "head", or else the last joint that
    is not close to the tip: at `_HEAD_SHARE` of the longest reach or more."""
    neck = max(necks, key=lambda chain: reach[chain[0]] + len(chain))
    named = [joint for joint in neck if "head" in skeleton.names[joint].lower()]
    high = [joint for joint in neck if reach[joint] >= _HEAD_SHARE * max(reach)]
    return named[0] if named else (high or neck)[-1]


def _left_first(skeleton: Skeleton, starts: Sequence[int], leftness: np.ndarray) -> Sequence[int]:
    """The first joints of two limbs, the left one first; their names or the rest pose decide."""
    side = left_or_right(*(skeleton.names[start] for start in starts))
    if side:
        return starts if side == "left" else starts[::-1]
    return sorted(starts, key=lambda start: -leftness[start])
