"""Repair of a motion (holden2015, section 7, "Fixing Corrupt Motion Data").

The paper projects the whole motion (`project_motion`), which also changes what was right. `repair`
changes only what is damaged.
"""

from dataclasses import replace
from functools import partial

import numpy as np

from numpy_cae.manifold.detect import direct_damage, find_damage, residual
from numpy_cae.manifold.fill import fill_positions, whole_features
from numpy_cae.manifold.holes import at_thirty, finite_motion, in_file
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.repaired import Repaired, change_joints, distances
from numpy_cae.manifold.smooth import smooth_motion
from numpy_cae.motion.features import VELOCITY, RootTransform, trajectory_of, velocities_along
from numpy_cae.motion.heading import SMOOTHING_SECONDS, smoothed
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.retarget.body import Body
from numpy_cae.motion.retarget.rigs import find_joints
from numpy_cae.motion.retarget.to_body import at_rate_of
from numpy_cae.motion.retarget.to_rig import retarget

UNKNOWN = 0.12
"""Metres of the largest typical residual of a motion like those that the manifold knows: more than
that of any take of a source left out of training (docs/lab_book/detection.md)."""


def repair(
    motion: Motion,
    manifold: MotionManifold,
    damaged: np.ndarray | None = None,
    strength: float = 1.0,
    smooth: bool = False,
    force: bool = False,
) -> Repaired:
    """Find what is damaged in a motion, fill it in, and leave the rest as it is, to the bit.

    Parameters
    ----------
    motion : Motion
        Of any rig in which the twenty joints can be found, at any rate.
    damaged : (frames, 20) array of bool, optional
        In the frames of the file; found by `find_damage` where None.
    strength : float
        Share of the way to the repaired positions, 0 to 1.
    smooth : bool
        Whether to remove jitter from the whole motion, by `smooth_motion`.
    force : bool
        Whether to repair a motion that is unlike what the manifold knows; otherwise it is returned
        unchanged, with `known` False.
    """
    if not 0 <= strength <= 1:
        raise ValueError(f"strength is {strength}, expected 0 to 1")
    motion, wrong = finite_motion(motion)
    body = manifold.body(motion)
    nothing = np.zeros((len(motion), len(JOINTS)), bool)
    if damaged is None:
        damaged = in_file(motion, find_damage(manifold, body)) | direct_damage(body)
    damaged = damaged | wrong[:, find_joints(motion.skeleton)]
    missing = at_thirty(motion, damaged)
    features, _ = whole_features(body, missing)
    distance = np.linalg.norm(residual(manifold, features, missing), axis=-1)
    middle = float(np.median(distance[~missing])) if not missing.all() else 0.0
    if middle > UNKNOWN and not force:
        return Repaired(motion, nothing, nothing.astype(float), middle, known=False)
    target = fill_positions(manifold, body, missing)
    repaired = change_joints(body, motion, target, damaged, strength, middle)
    if smooth:
        smoothed_motion = smooth_motion(repaired.motion)
        moved = distances(motion, smoothed_motion)
        # Every joint that moves counts as touched.
        repaired = replace(repaired, motion=smoothed_motion, touched=moved > 0, moved=moved)
    return repaired


def project_motion(motion: Motion, manifold: MotionManifold) -> Motion:
    """The motion projected onto the manifold, in its own rig: the paper's repair.

    The projection is the mean over all positions of the pooling grid. Frames between two poses at
    the manifold's rate follow a smooth curve through the projected poses. Joints beyond the twenty
    (fingers) and rotations of bones about their own axis stay as they were.

    Arguments are as in `repair`.

    Returns
    -------
    Motion
        Of the same skeleton, rate, unit and length.
    """
    # Of an hour, each array at 30 frames a second takes 50 MB: here only the poses are left.
    poses = _projected_poses(manifold.body(motion), manifold)
    return retarget(motion, partial(at_rate_of, motion, poses))


def _projected_poses(body: Body, manifold: MotionManifold) -> np.ndarray:
    projected = manifold.project(body.features, manifold.shifts)
    return body.positions_of(*keep_trajectory(body.features, projected, body.root, manifold.rate))


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
    floor = floor + smoothed(own_floor - floor, sigma)
    theta = theta + smoothed((own_theta - theta)[:, None], sigma)[:, 0]
    kept = projected.copy()
    kept[:, VELOCITY.start :] = velocities_along(floor, theta)
    return kept, RootTransform(floor[0, 0], floor[0, 2], theta[0])
