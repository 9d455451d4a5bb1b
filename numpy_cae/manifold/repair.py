"""A damaged motion, projected onto the manifold (holden2015, section 7, "Fixing Corrupt Motion
Data")."""

from __future__ import annotations

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.body import body_of
from numpy_cae.motion.features import features_to_positions
from numpy_cae.motion.fit import fit_motion
from numpy_cae.motion.lengths import bone_lengths, change_lengths
from numpy_cae.motion.motion import Motion


def repair(
    motion: Motion, manifold: MotionManifold, mapping: dict[str, str] | None = None
) -> Motion:
    """The motion on the manifold that stands for `motion`, on the bones of its own body.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.
    manifold : MotionManifold
    mapping : dict of our joint names to the rig's, optional

    Returns
    -------
    Motion
        The twenty joints at the manifold's rate, in the unit of the motion that came in.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    positions = body_of(motion, mapping)
    own = bone_lengths(positions)
    features, start = manifold.features(positions)
    projected = features_to_positions(manifold.project(features), start)
    return fit_motion(
        change_lengths(projected, manifold.lengths, own), own, manifold.rate, motion.unit
    )
