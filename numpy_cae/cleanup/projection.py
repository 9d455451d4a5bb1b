"""Projection of a whole motion onto the manifold, in its own rig: the repair of holden2015."""

import numpy as np

from numpy_cae.fast.thread_team import one_thread
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retargeting.body import Body, retarget_poses
from numpy_cae.motion.features import (
    SMOOTHING_SECONDS,
    VELOCITY,
    RootTransform,
    smooth,
    trajectory_of,
    velocities_along,
)
from numpy_cae.motion.motion import Motion


@one_thread()
def project_motion(motion: Motion, manifold: MotionManifold) -> Motion:
    """Project a whole motion onto the manifold, in its own rig.

    The projection is averaged over all shifts of the pooling grid. Frames between two poses at
    thirty frames a second follow a smooth curve through the projected poses. Joints beyond the
    twenty (fingers) and rotations of bones about their own axis stay as they were.

    Parameters
    ----------
    motion : Motion
        A motion at any rate, on any rig in which the twenty joints can be found.
    manifold : MotionManifold

    Returns
    -------
    Motion
        Its skeleton, rate, unit and length are those of `motion`.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import starter
    >>> from numpy_cae.cleanup import project_motion
    >>> motion = make_take("walk", 0, seconds=1.0, rate=120.0).motion
    >>> projected = project_motion(motion, starter())
    >>> len(projected), projected.rate
    (120, 120.0)
    """
    # The poses are computed in a function of its own, so that only they are kept.
    return retarget_poses(motion, _project_poses(Body(motion, manifold.lengths), manifold))


def _project_poses(body: Body, manifold: MotionManifold) -> np.ndarray:
    """The poses (F, 20, 3) of a body, projected."""
    projected = manifold.project(body.features, average_shifts=True)
    return body.positions_of(*keep_trajectory(body.features, projected, body.root, manifold.rate))


def keep_trajectory(
    file_features: np.ndarray, projected: np.ndarray, root: RootTransform, rate: float
) -> tuple[np.ndarray, RootTransform]:
    """Projected features on the slow part of the original root trajectory.

    The trajectory is the sum of velocity and turn, so the errors of the projected ones are summed
    too, and after a few seconds the body would be far off. Low frequencies of the trajectory are
    taken from the file, high frequencies from the projection. h is the
    position of the hips on the floor, θ the heading, ^ marks what is projected, and g * is the
    convolution with the Gaussian that smooths the heading:

        h = ĥ + g * (h_file - ĥ),    θ = θ̂ + g * (θ_file - θ̂)

    `file_features` and `projected` are (F, 63), `root` is of the first frame, and `rate` in frames
    a second. Returns `projected` with another velocity and turn, and the root of its first frame.
    """
    file_floor, file_theta = trajectory_of(file_features, root)
    floor, theta = trajectory_of(projected, root)
    sigma = SMOOTHING_SECONDS * rate
    floor = floor + smooth(file_floor - floor, sigma)
    theta = theta + smooth((file_theta - theta)[:, None], sigma)[:, 0]
    features = projected.copy()
    features[:, VELOCITY.start :] = velocities_along(floor, theta)
    return features, RootTransform(floor[0, 0], floor[0, 2], theta[0])
