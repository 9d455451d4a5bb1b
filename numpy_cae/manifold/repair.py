"""Repair of a motion by projection (holden2015, section 7, "Fixing Corrupt Motion Data")."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import VELOCITY, RootTransform, trajectory_of, velocities_along
from numpy_cae.motion.heading import SMOOTHING_SECONDS
from numpy_cae.motion.motion import Motion


def repair(
    motion: Motion, manifold: MotionManifold, mapping: dict[str, str] | None = None
) -> Motion:
    """The motion projected onto the manifold, in its own rig.

    The projection is the mean over all positions of the pooling grid. Frames between two poses at
    the manifold's rate follow a smooth curve through the projected poses. Joints beyond the twenty
    (fingers) and rotations of bones about their own axis stay as they were.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.
    manifold : MotionManifold
    mapping : dict of joint name to the rig's joint name, optional

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length.
    """
    body = manifold.body(motion, mapping)
    projected = manifold.project(body.features, manifold.shifts)
    return body.to_rig(*keep_trajectory(body.features, projected, body.root, manifold.rate))


def keep_trajectory(
    features: np.ndarray, projected: np.ndarray, root: RootTransform, rate: float
) -> tuple[np.ndarray, RootTransform]:
    """Projected features on the slow part of the original root trajectory.

    The projected velocity and turn are summed to a trajectory, and so are their errors: after a few
    seconds the body would be far off. Low frequencies of the trajectory are taken from the file,
    high frequencies from the projection. With the hips on the floor h (`floor`), the heading θ
    (`theta`) and the Gaussian g with which the heading is smoothed:

        h = ĥ + g * (h_file - ĥ),    θ = θ̂ + g * (θ_file - θ̂)

    `features` and `projected` are (F, 63), `root` is of the first frame, and `rate` in frames a
    second. Returns `projected` with another velocity and turn, and the root of its first frame.
    """
    own_floor, own_theta = trajectory_of(features, root)
    floor, theta = trajectory_of(projected, root)
    sigma = SMOOTHING_SECONDS * rate
    floor = floor + gaussian_filter1d(own_floor - floor, sigma, axis=0, mode="nearest")
    theta = theta + gaussian_filter1d(own_theta - theta, sigma, mode="nearest")
    kept = projected.copy()
    kept[:, VELOCITY.start :] = velocities_along(floor, theta)
    return kept, RootTransform(floor[0, 0], floor[0, 2], theta[0])
