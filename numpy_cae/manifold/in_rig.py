"""Features of a made motion, performed by a rig that a person brought."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import RootTransform, features_to_positions
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.to_body import RATE, at_rate_of, body_of
from numpy_cae.motion.retarget.to_rig import retarget


def in_rig(
    manifold: MotionManifold,
    features: np.ndarray,
    start: RootTransform,
    rig: Motion,
    mapping: dict[str, str] | None = None,
) -> Motion:
    """The rig's motion, cut to the length of the features, its twenty joints as they say.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        At the manifold's rate, on its mean skeleton; no more frames than the rig's motion has at
        that rate.
    start : RootTransform
        Where the body stands at first, on the mean skeleton.
    rig : Motion
        Its skeleton, rate and unit are kept, and of every joint beyond the twenty its rotation.
    mapping : dict of our joint names to the rig's, optional

    Returns
    -------
    Motion

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    own = bone_lengths(body_of(rig, mapping))
    asked = change_lengths(features_to_positions(features, start), manifold.lengths, own)
    cut = _first(rig, len(features))
    # Below 30 frames a second the last pose may lie after the last frame.
    asked = asked[: len(cut.source_frames(RATE))]
    return retarget(cut, at_rate_of(cut, asked), mapping)


def standing_still(rig: Motion, frames: int) -> Motion:
    """The first pose of a motion, held for so many frames at `RATE`."""
    held = np.zeros(int(np.ceil((frames + 1) * rig.rate / RATE)) + 1, dtype=int)
    return replace(rig, rotations=rig.rotations[held], translations=rig.translations[held])


def _first(motion: Motion, poses: int) -> Motion:
    """The frames before the pose at `RATE` that is one too many."""
    moments = motion.source_frames(RATE)
    frames = len(motion) if poses == len(moments) else int(np.ceil(moments[poses]))
    return replace(
        motion, rotations=motion.rotations[:frames], translations=motion.translations[:frames]
    )
