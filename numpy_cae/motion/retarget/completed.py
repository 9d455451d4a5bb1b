"""Add joints to a rig that lacks some of the twenty, where their place is known.

Many rigs end at the ankle, with the toes as its End Site, or have one bone from the hips to the
chest or from the chest to the shoulder. A point that is fixed to a bone of the rig stands for the
missing joint. No writer writes it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.rigs import ADDED, Mappings, match_rig

_SPINE = 0.5
_COLLAR = 0.3
"""Parts of the way from hips to chest and from chest to shoulder, as in CMU's rig."""


def completed(motion: Motion, mapping: Mappings = None) -> Motion:
    """The motion with the missing ones of the twenty joints added at its end.

    It is returned as it is if nothing is missing or the place of a missing joint is not known.
    """
    skeleton = motion.skeleton
    found = match_rig(skeleton, mapping)[1]
    missing = [joint for joint in JOINTS if joint not in found]
    names, parents, offsets = [], [], []
    for joint in missing:
        index = JOINTS.index(joint)
        parent = found.get(JOINTS[PARENTS[index]], -1)
        child = next(
            (found[JOINTS[c]] for c, p in enumerate(PARENTS) if p == index and JOINTS[c] in found),
            -1,
        )
        offset = skeleton.end_sites.get(parent, np.zeros(3)) if child < 0 else np.zeros(3)
        if child >= 0 and skeleton.parents[child] == parent:
            part = _SPINE if joint == "spine" else _COLLAR
            offset = part * motion.translations[:, child].mean(axis=0)
        if parent < 0 or not offset.any():
            return motion
        names.append(joint + ADDED)
        parents.append(parent)
        offsets.append(offset)
    if not missing:
        return motion
    frames, added = len(motion), len(missing)
    return replace(
        motion,
        skeleton=replace(
            skeleton,
            names=(*skeleton.names, *names),
            parents=(*skeleton.parents, *parents),
            offsets=np.concatenate([skeleton.offsets, offsets]),
            added=added,
        ),
        rotations=np.concatenate(
            [motion.rotations, np.tile([0.0, 0.0, 0.0, 1.0], (frames, added, 1))], axis=1
        ),
        translations=np.concatenate(
            [motion.translations, np.tile(offsets, (frames, 1, 1))], axis=1
        ),
    )


def without_added(motion: Motion) -> Motion:
    """The motion of the joints that the file has."""
    skeleton = motion.skeleton
    if not skeleton.added:
        return motion
    joints = len(skeleton.names) - skeleton.added
    return replace(
        motion,
        skeleton=replace(
            skeleton,
            names=skeleton.names[:joints],
            parents=skeleton.parents[:joints],
            offsets=skeleton.offsets[:joints],
            added=0,
        ),
        rotations=motion.rotations[:, :joints],
        translations=motion.translations[:, :joints],
    )
