"""A motion of any rig and length, on jang2018's manifold and back in its rig."""

from __future__ import annotations

import numpy as np

from numpy_cae.manifold.long_sequences import project_sequence
from numpy_cae.manifold.sequence_manifold import SequenceManifold
from numpy_cae.motion.angles import angles_of
from numpy_cae.motion.io.t_pose import without_t_pose
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.to_body import at_rate_of, body_of
from numpy_cae.motion.retarget.to_rig import retarget


def repair_sequence(
    motion: Motion, manifold: SequenceManifold, mapping: dict[str, str] | None = None
) -> Motion:
    """The motion on the manifold that stands for `motion`, on the rig that came in.

    Parameters
    ----------
    motion : Motion
        Of the action that the manifold was learned from, at any rate and of any length.
    manifold : SequenceManifold
    mapping : dict of our joint names to the rig's, optional

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length, but without a T-pose before it.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    motion = without_t_pose(motion, mapping)
    projected = body_of(project_sequence(manifold, angles_of(motion, mapping)))
    own = body_of(motion, mapping)
    asked = change_lengths(projected, bone_lengths(projected), bone_lengths(own))
    # `change_lengths` moves hips by the ratio of the legs, but these are where the file's were.
    asked += projected[:, :1] - asked[:, :1]
    # 25 frames a second may end up to 1/25 s before 30 do.
    asked = np.concatenate([asked, asked[-1:].repeat(max(len(own) - len(asked), 0), axis=0)])
    return retarget(motion, at_rate_of(motion, asked[: len(own)]), mapping)
