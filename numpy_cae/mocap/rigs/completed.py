"""Add those of the twenty joints that a rig lacks, if their positions are known.

In many rigs a leg ends at the ankle, with the toes as its End Site, or one bone connects the hips
with the chest or the chest with a shoulder. The joint that is added is a point fixed to a bone of
the rig. Added joints are never written to a file.

A rig may also end at ankles or chest without an End Site. Then toes are added in front of the ankle
and a head above the chest, at a person's distance, as points fixed to ankle and chest.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.mocap.rigs.rigs import Rig, RiggedMotion
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import IDENTITY, inverse, rotate

_BETWEEN = {
    "spine": ("chest", 0.5),
    "left_collar": ("left_shoulder", 0.3),
    "right_collar": ("right_shoulder", 0.3),
}
"""Missing joint -> (the joint where its bone ends, how far along the bone it is added, 0 to 1). The
shares are those of CMU's rig."""


_TOE, _HEAD = 0.33, 0.6
"""_TOE, _HEAD: the distance from the ankle to an added toe in shins, and from the chest to an added
head in thighs; in the files of five sources they are 0.23 to 0.5 and 0.45 to 0.75."""
_SHORT = 0.1
"""_SHORT: an End Site nearer to the ankle than this part of the shin is no toe."""
_POSES = 100
"""_POSES: about this many poses of a motion are measured."""


def completed(motion: RiggedMotion, estimate: bool = False) -> RiggedMotion:
    """The motion with the missing ones of the twenty joints added after its own joints.

    The same motion if the position of a missing joint is not known. If `estimate`, toes and a head
    without an End Site are added at a person's distance.
    """
    rig = motion.rig
    missing = [joint for joint in JOINTS if joint not in rig.found]
    parents = [rig.found.get(JOINTS[PARENTS[JOINTS.index(joint)]], -1) for joint in missing]
    ends = zip(missing, parents, strict=True)
    offsets = [_offset(motion, rig, joint, parent, estimate) for joint, parent in ends]
    if not missing or -1 in parents or not all(offset.any() for offset in offsets):
        return motion
    skeleton = motion.skeleton
    extended = replace(
        skeleton,
        names=(*skeleton.names, *(f"{joint} (added)" for joint in missing)),
        parents=(*skeleton.parents, *parents),
        offsets=np.concatenate([skeleton.offsets, offsets]),
    )
    added = range(len(skeleton.names), len(extended.names))
    still = np.tile(IDENTITY, (len(motion), len(missing), 1))
    places = np.tile(offsets, (len(motion), 1, 1))
    found = rig.found | dict(zip(missing, added, strict=True))
    return replace(
        motion,
        skeleton=extended,
        rotations=np.concatenate([motion.rotations, still], axis=1),
        translations=np.concatenate([motion.translations, places], axis=1),
        rig=replace(rig, found=found, added=tuple(added)),
    )


def _offset(motion: Motion, rig: Rig, joint: str, parent: int, estimate: bool) -> np.ndarray:
    """The offset of a missing joint from its parent in the rig; zero if it is not known."""
    skeleton = motion.skeleton
    offset = np.zeros(3)
    end, part = _BETWEEN.get(joint, ("", 0.0))
    found = rig.found
    if end in found and skeleton.parents[found[end]] == parent:
        offset = part * np.nanmean(motion.translations[:, found[end]], axis=0)
    elif JOINTS.index(joint) not in PARENTS:
        offset = skeleton.end_sites.get(parent, offset)
    if estimate and (joint == "head" or joint.endswith("toe")):
        offset = _estimated(motion.sampled(_POSES), joint, found, offset)
    return offset


def _estimated(
    poses: Motion, joint: str, found: dict[str, int], end_site: np.ndarray
) -> np.ndarray:
    """The offset of a toe or the head from the ankle or the chest: that of its End Site, or if it
    is too short or missing, the median of the poses; zero if the joints around it are missing."""
    side = joint.removesuffix("toe")
    names = {"hips", "chest", "left_hip", "left_knee", "right_hip"}
    names |= {f"{side}knee", f"{side}ankle"} if joint != "head" else set()
    if not names <= set(found):
        return np.zeros(3)
    positions, rotations = poses.forward_kinematics()
    at = {name: positions[:, found[name]] for name in names}
    parent = "chest" if joint == "head" else f"{side}ankle"
    if joint == "head":
        along = _unit(at["chest"] - at["hips"])
        distance = _HEAD * np.linalg.norm(at["left_knee"] - at["left_hip"], axis=-1)
    else:
        shin = at[f"{side}ankle"] - at[f"{side}knee"]
        forward = np.cross(at["left_hip"] - at["right_hip"], -shin)
        along = 0.87 * _unit(forward) + 0.5 * _unit(shin)  # as in `REST_DIRECTIONS`
        distance = _TOE * np.linalg.norm(shin, axis=-1)
        if np.linalg.norm(end_site) > _SHORT / _TOE * np.median(distance):
            return end_site
    offsets = rotate(inverse(rotations[:, found[parent]]), distance[:, None] * along)
    return np.median(offsets, axis=0)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
