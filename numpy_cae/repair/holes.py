"""A motion with holes, as features that a network fills in, and back in its rig."""

from dataclasses import replace

import numpy as np

from numpy_cae.manifold.fill import fill
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.mocap.retarget.body import Body, at_rate_of, body_of
from numpy_cae.mocap.retarget.to_rig import retarget
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion.features import (
    bone_lengths,
    change_lengths,
    features_to_positions,
    local_positions,
    positions_to_features,
)
from numpy_cae.motion.hole_curves import CurveAt, eased_everywhere
from numpy_cae.motion.masks import at_thirty
from numpy_cae.motion.motion import RATE, Motion
from numpy_cae.repair.finding import Finding
from numpy_cae.repair.interpolated import interpolate_channels, missing_joints, on_curves


class Holes:
    """A motion in which some joints are damaged or missing in some frames.

    Parameters
    ----------
    body : Body
        The body of the motion.
    in_file : (frames, 20) array of bool
        What is damaged or missing, in the frames of the file.
    start : Motion, optional
        The frames of the motion that have holes, with the damaged rotations of the rig
        interpolated; those of `on_curves` where None. All frames of an hour would take half a
        gigabyte more.

    Attributes
    ----------
    mask : (F, 20) array of bool
        What is damaged or missing at thirty frames a second.
    start : Motion
    features, root : (F, 63) array of float64, RootTransform
        Of the motion with the joints of the holes where they are in `start`: the X_0 of `fill`.
    """

    def __init__(self, body: Body, in_file: np.ndarray, start: Motion | None = None):
        self.motion = body.motion
        self.mean_lengths = body.mean_lengths
        self.in_file = in_file
        self.mask = at_thirty(body.motion, in_file)
        there = np.asarray(in_file.any(axis=1))
        self.start = on_curves(body.motion, in_file).at(there) if start is None else start
        positions = _positions_with(body, there, self.start)
        self.lengths = bone_lengths(positions)
        positions = np.where(self.mask[..., None], positions, body.positions)
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
        filled = fill(manifold, self.features, self.mask)
        projected = manifold.project(filled, average_shifts=True)
        distance = np.linalg.norm(local_positions(self.features - projected), axis=-1)
        return float(np.median(distance[~self.mask]))

    def filled(self, features: np.ndarray) -> Motion:
        """The motion with the joints of the holes, and nothing else, moved to those of features
        (F, 63) on the mean skeleton."""
        motion = self.motion
        holes = self.in_file
        if not holes.any():
            return motion
        correction = self.positions_of(features) - self.positions_of(self.features)
        correction[~self.mask] = 0.0
        weight = _ramps(holes, motion.rate)
        joints = rig_of(motion).joints
        row = np.cumsum(holes.any(axis=1)) - 1  # of a frame in `start`

        def targets(frames: np.ndarray) -> np.ndarray:
            after = self.start.at(row[frames]).positions(joints)
            moved = at_rate_of(motion, correction, frames)
            return after + moved * weight[frames, :, None]

        return retarget(motion, targets, holes, self.start)


def holes_of(body: Body, findings: list[Finding], curve_at: CurveAt = eased_everywhere) -> Holes:
    """The holes of findings, with their damaged channels interpolated."""
    missing = missing_joints(body.motion, findings)
    there = np.asarray(missing.any(axis=1))
    return Holes(body, missing, interpolate_channels(body.motion, findings, curve_at, there))


def _positions_with(body: Body, there: np.ndarray, start: Motion) -> np.ndarray:
    """The positions (F, 20, 3) of a body whose motion is `start` in the frames of a mask."""
    motion, source = body.motion, body.motion.source_frames(RATE)
    if source.dtype == int:  # frames are only dropped: no other pose changes
        positions = body.positions.copy()
        poses = np.flatnonzero(there[source])
        rows = (np.cumsum(there) - 1)[source[poses]]
        positions[poses] = start.at(rows).positions(rig_of(motion).joints)
        return positions
    rotations, translations = motion.rotations.copy(), motion.translations.copy()
    rotations[there], translations[there] = start.rotations, start.translations
    return body_of(replace(motion, rotations=rotations, translations=translations))


def _ramps(holes: np.ndarray, rate: float) -> np.ndarray:
    """A weight for each frame of a mask (frames, 20): 0 outside the holes, and within them it rises
    smoothly to 1 in 1/30 s from each end. A correction at thirty frames a second, resampled, is not
    exactly zero next to a hole; with this weight neither place nor speed jumps."""
    frame = np.arange(len(holes), dtype=np.float32)[:, None]
    before = np.maximum.accumulate(np.where(holes, -np.inf, frame), axis=0)
    after = np.minimum.accumulate(np.where(holes, np.inf, frame)[::-1], axis=0)[::-1]
    u = np.minimum(np.minimum(frame - before, after - frame) * (RATE / rate), 1.0)
    return u * u * (3 - 2 * u)
