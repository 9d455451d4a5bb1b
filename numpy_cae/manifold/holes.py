"""A motion with holes, as features that a network fills in, and back in its rig."""

from dataclasses import replace

import numpy as np

from numpy_cae.manifold.detect import residual
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.features import features_to_positions, positions_to_features
from numpy_cae.motion.lengths import change_lengths
from numpy_cae.motion.masks import at_thirty
from numpy_cae.motion.motion import RATE, Motion
from numpy_cae.motion.retarget.body import Body, at_rate_of
from numpy_cae.motion.retarget.curves import on_curves
from numpy_cae.motion.retarget.rigs import find_joints
from numpy_cae.motion.retarget.to_rig import retarget


class Holes:
    """A motion in which some joints are damaged or missing in some frames.

    Parameters
    ----------
    body : Body
        The body of the motion.
    in_file : (frames, 20) array of bool
        What is damaged or missing, in the frames of the file.
    interpolated : Motion, optional
        The motion with the damaged rotations of the rig interpolated; that of `on_curves` where
        None.

    Attributes
    ----------
    mask : (F, 20) array of bool
        What is damaged or missing at thirty frames a second.
    start : Motion
        The frames of `interpolated` that have holes. All frames of an hour would take half a
        gigabyte more.
    features, root : (F, 63) array of float64, RootTransform
        Of the motion with the joints of the holes where they are in `start`: the X_0 of `fill`.
    """

    def __init__(self, body: Body, in_file: np.ndarray, interpolated: Motion | None = None):
        self.motion, self.mean_lengths, self.in_file = body.motion, body.mean_lengths, in_file
        self.mask = at_thirty(body.motion, in_file)
        start = replace(body, motion=interpolated or on_curves(body.motion, in_file))
        self.start = start.motion.at(np.asarray(in_file.any(axis=1)))
        self.lengths = start.lengths
        positions = np.where(self.mask[..., None], start.positions, body.positions)
        positions = change_lengths(positions, self.lengths, body.mean_lengths)
        self.features, self.root = positions_to_features(positions, RATE)

    def positions_of(self, features: np.ndarray) -> np.ndarray:
        """World positions of features (F, 63) on the motion's own bones, (F, 20, 3) in metres."""
        on_mean_bones = features_to_positions(features, self.root)
        return change_lengths(on_mean_bones, self.mean_lengths, self.lengths)

    def typical_residual(self, manifold: MotionManifold) -> float:
        """The median distance of a joint outside the holes from its projection, metres."""
        if self.mask.all():
            return 0.0
        distance = np.linalg.norm(residual(manifold, self.features, self.mask), axis=-1)
        return float(np.median(distance[~self.mask]))

    def filled(self, features: np.ndarray) -> Motion:
        """The motion with the joints of the holes, and nothing else, moved to those of features
        (F, 63) on the mean skeleton."""
        motion, holes = self.motion, self.in_file
        if not holes.any():
            return motion
        correction = self.positions_of(features) - self.positions_of(self.features)
        correction[~self.mask] = 0.0
        weight = _ramps(holes, motion.rate)
        joints = find_joints(motion.skeleton)
        row = np.cumsum(holes.any(axis=1)) - 1  # of a frame in `start`

        def targets(frames: np.ndarray) -> np.ndarray:
            after = self.start.at(row[frames]).positions(joints)
            moved = at_rate_of(motion, correction, frames)
            return after + moved * weight[frames, :, None]

        return retarget(motion, targets, holes, self.start)


def _ramps(holes: np.ndarray, rate: float) -> np.ndarray:
    """A weight for each frame of a mask (frames, 20): 0 outside the holes, and within them it rises
    smoothly to 1 in 1/30 s from each end. A correction at thirty frames a second, resampled, is not
    exactly zero next to a hole; with this weight neither place nor speed jumps."""
    frame = np.arange(len(holes), dtype=np.float32)[:, None]
    before = np.maximum.accumulate(np.where(holes, -np.inf, frame), axis=0)
    after = np.minimum.accumulate(np.where(holes, np.inf, frame)[::-1], axis=0)[::-1]
    u = np.minimum(np.minimum(frame - before, after - frame) * (RATE / rate), 1.0)
    return u * u * (3 - 2 * u)
