"""Add those of the twenty joints that a rig lacks, if their positions are known.

In many rigs a leg ends at the ankle, with the toes as its End Site, or one bone connects the hips
with the chest or the chest with a shoulder. The joint that is added is a point fixed to a bone of
the rig. Added joints are never written to a file.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.quaternions import IDENTITY
from numpy_cae.motion.retarget.rigs import ADDED, match_rig

_BETWEEN = {
    "spine": ("chest", 0.5),
    "left_collar": ("left_shoulder", 0.3),
    "right_collar": ("right_shoulder", 0.3),
}
"""Missing joint -> (the joint where its bone ends, how far along the bone it is added, 0 to 1). The
shares are those of CMU's rig."""


def completed(motion: Motion) -> Motion:
    """The motion with the missing ones of the twenty joints added after its own joints.

    The same motion if no joint is missing, or if the position of a missing one is not known.
    """
    skeleton = motion.skeleton
    found = match_rig(skeleton)[1]
    missing = [joint for joint in JOINTS if joint not in found]
    parents = [found.get(JOINTS[PARENTS[JOINTS.index(joint)]], -1) for joint in missing]
    offsets = []
    for joint, parent in zip(missing, parents, strict=True):
        offset = np.zeros(3)
        end, part = _BETWEEN.get(joint, ("", 0.0))
        if end in found and skeleton.parents[found[end]] == parent:
            offset = part * motion.translations[:, found[end]].mean(axis=0)
        elif JOINTS.index(joint) not in PARENTS:
            offset = skeleton.end_sites.get(parent, offset)
        if parent < 0 or not offset.any():
            return motion
        offsets.append(offset)
    if not missing:
        return motion
    extended = replace(
        skeleton,
        names=(*skeleton.names, *(joint + ADDED for joint in missing)),
        parents=(*skeleton.parents, *parents),
        offsets=np.concatenate([skeleton.offsets, offsets]),
        added=len(missing),
    )
    still = np.tile(IDENTITY, (len(motion), len(missing), 1))
    places = np.tile(offsets, (len(motion), 1, 1))
    rotations = np.concatenate([motion.rotations, still], axis=1)
    translations = np.concatenate([motion.translations, places], axis=1)
    return replace(motion, skeleton=extended, rotations=rotations, translations=translations)
