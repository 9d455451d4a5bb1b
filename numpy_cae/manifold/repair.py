"""A damaged motion, projected onto the manifold (holden2015, section 7, "Fixing Corrupt Motion
Data")."""

from __future__ import annotations

from numpy_cae.manifold.constrained import project_constrained
from numpy_cae.manifold.in_rig import in_rig
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.body import body_of
from numpy_cae.motion.motion import Motion


def repair(
    motion: Motion,
    manifold: MotionManifold,
    mapping: dict[str, str] | None = None,
    constrained: bool = False,
) -> Motion:
    """The motion on the manifold that stands for `motion`, on the rig that came in: the mean of its
    projections at all places of the pooling grid (`manifold.blind.project_shifted`).

    What the file has between two poses at the manifold's rate is as damaged as they are. So the
    twenty joints follow the projected poses alone, smoothly joined; the joints beyond them
    (fingers, tips) and the twist of bones, of which positions say nothing, stay as they came.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.
    manifold : MotionManifold
    mapping : dict of our joint names to the rig's, optional
    constrained : bool
        Keep bone lengths, standing feet and the ground: `project_constrained`.

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    features, start = manifold.features(body_of(motion, mapping))
    if constrained:
        projected = project_constrained(manifold, features, start)
    else:
        projected = manifold.project(features, manifold.shifts)
    return in_rig(manifold, projected, start, motion, mapping)
