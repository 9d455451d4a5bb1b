"""A damaged motion, projected onto the manifold (holden2015, section 7, "Fixing Corrupt Motion
Data")."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d

from numpy_cae.manifold.in_rig import in_rig
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import VELOCITY, RootTransform, trajectory_of, velocities_along
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.to_body import body_of

WAY_SECONDS = 1 / 3
"""Spread of the Gaussian that tells the slow part of a way, as for the heading."""


def repair(
    motion: Motion,
    manifold: MotionManifold,
    mapping: dict[str, str] | None = None,
    constrained: bool = False,
    pins: Sequence = (),
) -> Motion:
    """The motion on the manifold that stands for `motion`, on the rig that came in: the mean of its
    projections at all places of the pooling grid (`manifold.blind.project_shifted`).

    What the file has between two poses at the manifold's rate is as damaged as they are. So the
    twenty joints follow the projected poses alone, smoothly joined, along the file's way; the
    joints beyond them (fingers, tips) and the twist of bones, of which positions say nothing,
    stay as they came.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.
    manifold : MotionManifold
    mapping : dict of our joint names to the rig's, optional
    constrained : bool
        Keep bone lengths, standing feet and the ground: `project_constrained`.
    pins : sequence of Pin
        Where joints are wanted; with any, the projection is constrained.

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length.

    Raises
    ------
    UnknownRigError
        If joints are missing.
    """
    from numpy_cae.beyond.constrained import project_constrained
    from numpy_cae.beyond.pins import pins_for

    features, start = manifold.features(body_of(motion, mapping))
    if constrained or pins:
        wanted = pins_for(pins, motion, manifold, mapping) if pins else None
        start = wanted.start(start) if wanted else start
        # Its feet stand in the world: another way would let them slide.
        kept = project_constrained(manifold, features, start, pins=wanted)
        return in_rig(manifold, kept, start, motion, mapping)
    projected = manifold.project(features, manifold.shifts)
    kept, start = kept_on_way(features, projected, start, manifold.rate)
    return in_rig(manifold, kept, start, motion, mapping)


def kept_on_way(
    features: np.ndarray, projected: np.ndarray, start: RootTransform, rate: float
) -> tuple[np.ndarray, RootTransform]:
    """Projected features that lead where the motion's own did.

    A network's velocity and turn are summed up to a way, and with them all of their errors: after a
    few seconds the body would stand far off and face elsewhere. So only what is quick in the way is
    the projection's; what is slow, seen by a Gaussian g of `WAY_SECONDS`, is the file's:

        h = ĥ + g * (h_file - ĥ),    θ = θ̂ + g * (θ_file - θ̂)

    Parameters
    ----------
    features, projected : (F, 63) arrays of float
        Of the motion, and what became of them.
    start : RootTransform
        Of the motion.
    rate : float
        Frames a second.

    Returns
    -------
    features : (F, 63) array of float64
        `projected` but for velocity and turn.
    start : RootTransform
    """
    (own_floor, own_theta), (floor, theta) = (
        trajectory_of(features, start),
        trajectory_of(projected, start),
    )
    sigma = WAY_SECONDS * rate
    floor = floor + gaussian_filter1d(own_floor - floor, sigma, axis=0, mode="nearest")
    theta = theta + gaussian_filter1d(own_theta - theta, sigma, mode="nearest")
    kept = projected.copy()
    kept[:, VELOCITY.start :] = velocities_along(floor, theta)
    return kept, RootTransform(floor[0, 0], floor[0, 2], theta[0])
