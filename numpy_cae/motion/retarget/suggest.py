"""Suggest which joints of an unknown rig are the twenty, from its hierarchy and rest pose.

A person has two pairs of limbs that are mirror images: the legs hang from the hips, the arms from
the chest, which is above the hips on another branch. Of all such pairs the longest are taken. Knees
and elbows divide a limb into two long bones of nearly the same length.
"""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np

from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.skeleton import Skeleton

_MAX_JOINTS = 1000
_SAME = 0.15
"""Largest difference of the lengths of a left and a right limb, relative to the longer."""
_LONG = 0.75
"""Least length of the shorter of the two bones of a limb, relative to the longest such pair."""
_HEAD = 0.06
"""Least distance from the head joint to the top of the head, relative to the length of a leg."""

_Pair = tuple[int, int, int]
"""Where a pair of limbs begins: the joint that carries both, and the first joint of each."""


def suggest_mapping(skeleton: Skeleton) -> dict[str, str]:
    """A mapping of our joint names to those of an unknown rig, as far as its hierarchy tells.

    Joints that the rig seems to lack are left out; it is empty if nothing looks like a person.
    """
    if len(skeleton.names) > _MAX_JOINTS:
        return {}
    chains = _chains(skeleton)
    lengths = [_length(skeleton, chain) for chain in chains]
    pairs = _pairs(skeleton, lengths)
    best, longest = None, 0.0
    for legs, arms in ((legs, arms) for legs in pairs for arms in pairs):
        above = skeleton.path(arms[0])
        if legs[0] not in above[1:] or set(legs[1:]) & set(above):
            continue
        total = lengths[legs[1]] + lengths[arms[1]]
        if total > longest:
            best, longest = (legs, arms), total
    if best is None:
        return {}
    legs, arms = best
    found = {"hips": legs[0], "chest": arms[0]}
    head = _head(skeleton, arms, chains, lengths)
    if head is not None:
        found["head"] = head
    for pair, names in (
        (legs, ("", "hip", "knee", "ankle", "toe")),
        (arms, ("collar", "shoulder", "elbow", "wrist", "")),
    ):
        for side, start in zip(
            ("left", "right"), _left_first(skeleton, pair, legs, arms), strict=True
        ):
            for name, joint in zip(names, _limb(skeleton, chains[start]), strict=True):
                if name and joint is not None:
                    found[f"{side}_{name}"] = joint
    add_trunk(skeleton, found, {"hips", "chest"})
    return {joint: skeleton.names[found[joint]] for joint in JOINTS if joint in found}


def add_trunk(skeleton: Skeleton, found: dict[str, int], named: set[str]) -> None:
    """Find chest and spine by hierarchy where they are missing or the collars are above the chest.

    `named` joints stay as the user says.
    """
    arms = next((f"{{}}_{arm}" for arm in ("collar", "shoulder") if f"left_{arm}" in found), None)
    if arms is None or arms.format("right") not in found or "hips" not in found:
        return
    left, right = (skeleton.path(found[arms.format(side)]) for side in ("left", "right"))
    carrier = next((joint for joint in left[1:] if joint in right[1:]), -1)
    below = skeleton.path(carrier)[1:] if carrier >= 0 else []
    if "chest" not in named and found.get("chest", found["hips"]) in below:
        found["chest"] = carrier
        if "spine" not in named:
            found.pop("spine", None)
    if {"chest", "spine"} & (named | set(found)) != {"chest"} or found["hips"] not in below:
        return
    between = below[: below.index(found["hips"])]
    if between:
        lengths = np.linalg.norm(skeleton.offsets, axis=-1)
        # Distance from the chest down to each joint between.
        down = np.cumsum(lengths[[carrier, *between]])
        found["spine"] = between[int(np.argmin(np.abs(down[:-1] - down[-1] / 2)))]


def _chains(skeleton: Skeleton) -> list[list[int]]:
    """From each joint the longest way down to a tip."""
    chains: list[list[int]] = [[] for _ in skeleton.names]
    reach = np.zeros(len(skeleton.names))
    for joint in reversed(range(len(skeleton.names))):
        tip = np.linalg.norm(skeleton.end_sites.get(joint, np.zeros(3)))
        below = {
            child: reach[child] + np.linalg.norm(skeleton.offsets[child])
            for child in skeleton.children(joint)
        }
        reach[joint] = max([float(tip), *below.values()])
        longest = max(below, key=lambda child: below[child], default=None)
        chains[joint] = [joint, *(chains[longest] if longest is not None else [])]
    return chains


def _length(skeleton: Skeleton, chain: list[int]) -> float:
    """The length of a chain of joints with the tip of the last."""
    tip = skeleton.end_sites.get(chain[-1], np.zeros(3))
    return float(np.linalg.norm(skeleton.offsets[chain[1:]], axis=-1).sum() + np.linalg.norm(tip))


def _pairs(skeleton: Skeleton, lengths: list[float]) -> list[_Pair]:
    """All pairs of branches of one joint that are nearly of the same length and not tiny."""
    found = []
    for joint in range(len(skeleton.names)):
        for one, other in combinations(skeleton.children(joint), 2):
            short, long = sorted((lengths[one], lengths[other]))
            if long - short <= _SAME * long and short > 0.1 * max(lengths):
                found.append((joint, one, other))
    return found


def _limb(skeleton: Skeleton, chain: list[int]) -> tuple[int | None, ...]:
    """The joint before the limb, its three joints and the next one: collar, shoulder, elbow, wrist
    of an arm; hip, knee, ankle, toe of a leg; None where there is none."""
    chain = [
        joint
        for joint in chain
        if not re.search(r"twist|roll|[._]0\d\d$", skeleton.names[joint], re.IGNORECASE)
    ]
    ways = [skeleton.path(joint) for joint in chain]
    bones = [
        float(np.linalg.norm(skeleton.offsets[way[: way.index(start)]], axis=-1).sum())
        for way, start in zip(ways[1:], chain, strict=False)
    ]
    if len(bones) < 2:
        return None, None, None, None, None
    # Of all neighbours the last two bones that are both long: a collar may be as long as a forearm.
    shorter = np.minimum(bones[:-1], bones[1:])
    first = int(np.flatnonzero(shorter >= _LONG * shorter.max())[-1])
    padded = [None, *chain, None]
    return tuple(padded[first : first + 5])


def _head(
    skeleton: Skeleton, arms: _Pair, chains: list[list[int]], lengths: list[float]
) -> int | None:
    """On the longest other branch of the chest, the last joint that is well below the tip."""
    others = [child for child in skeleton.children(arms[0]) if child not in arms]
    if not others:
        return None
    chain = chains[max(others, key=lambda child: lengths[child] + len(chains[child]))]
    named = [joint for joint in chain if "head" in skeleton.names[joint].lower()]
    high = [joint for joint in chain if lengths[joint] >= _HEAD * max(lengths)]
    return named[0] if named else (high or chain)[-1]


def _left_first(skeleton: Skeleton, pair: _Pair, legs: _Pair, arms: _Pair) -> tuple[int, int]:
    """The two branches of a pair, the left one first: by their names or by the rest pose."""
    one, other = pair[1:]
    sides = [
        _side(skeleton.names[one], skeleton.names[other]) for one, other in (pair[1:], pair[:0:-1])
    ]
    if sides in (["l", "r"], ["r", "l"]):
        return (one, other) if sides[0] == "l" else (other, one)
    places = np.array(
        [skeleton.offsets[skeleton.path(j)].sum(axis=0) for j in range(len(skeleton.names))]
    )
    up = places[arms[0]] - places[legs[0]]
    feet = [_limb(skeleton, _chains(skeleton)[start]) for start in legs[1:]]
    forward = np.sum(
        [places[toe] - places[ankle] for *_, ankle, toe in feet if toe and ankle], axis=0
    )
    left = np.cross(up, forward) if np.ndim(forward) else np.array([1.0, 0.0, 0.0])
    return (one, other) if (places[one] - places[other]) @ left >= 0 else (other, one)


def _side(name: str, other: str) -> str:
    """The first letter of what is in one name and not in the other: l for left, r for right."""
    start = next((i for i, (a, b) in enumerate(zip(name, other, strict=False)) if a != b), 0)
    return name[start : start + 1].lower() if re.search("[lr]", name[start:], re.I) else ""
