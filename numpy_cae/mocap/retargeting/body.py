"""Conversion of a motion of any rig to the features of a network, and back to the rig.

file -> Motion -> Body -> features -> network -> features -> Body -> Motion -> file
"""

from functools import partial

import numpy as np

from numpy_cae.mocap.retargeting.to_rig import retarget
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.mocap.rigs.rigs import UnknownRigError
from numpy_cae.motion import RATE, Motion, bone_lengths, change_lengths, positions_to_features
from numpy_cae.motion.features import RootTransform, features_to_positions, problem_of


def body_positions(motion: Motion) -> np.ndarray:
    """World positions of the twenty joints in each frame of the motion.

    Parameters
    ----------
    motion : Motion

    Returns
    -------
    (frames, 20, 3) array of float64
        Metres, at the rate of the motion.

    Raises
    ------
    UnknownRigError
        If joints are missing, or the bones are not a person's.

    Examples
    --------
    >>> from data_synth import make_take
    >>> body_positions(make_take("walk", 1, seconds=2.0, rate=120.0).motion).shape
    (240, 20, 3)
    """
    positions = motion.positions(rig_of(motion).joints)
    problem = problem_of(positions)
    if problem:
        raise UnknownRigError(problem)
    return positions


def body_of(motion: Motion) -> np.ndarray:
    """World positions of the twenty joints at thirty frames a second (`RATE`).

    Parameters
    ----------
    motion : Motion
        Any rate, and any rig in which the twenty joints can be found.

    Returns
    -------
    (F, 20, 3) array of float64
        Metres.

    Raises
    ------
    UnknownRigError
        If joints are missing, or the bones are not a person's.

    Examples
    --------
    >>> from data_synth import make_take
    >>> body_of(make_take("walk", 1, seconds=2.0, rate=120.0).motion).shape
    (60, 20, 3)
    """
    return body_positions(motion.resampled(RATE))


def at_rate_of(
    motion: Motion, positions: np.ndarray, frames: np.ndarray | None = None
) -> np.ndarray:
    """Positions at `RATE` resampled to the frames of a motion: the inverse of `body_of` in time.

    The interpolation is Akima's modified cubic, smooth and local: poses at rest stay at rest.
    Frames after the last pose, less than 1/30 s, are extrapolated linearly.

    Parameters
    ----------
    motion : Motion
    positions : (F', N, 3) array of float
        As many poses as `body_of(motion)` has.
    frames : (F,) array of int, optional
        Frames of the motion, ascending; all by default.

    Returns
    -------
    (F, N, 3) array of float64

    Raises
    ------
    ValueError
        If `positions` has another number of poses.

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 1, seconds=2.0, rate=120.0).motion
    >>> positions = body_of(walk)
    >>> len(positions), len(at_rate_of(walk, positions))
    (60, 240)
    """
    times = motion.source_frames(RATE)
    if len(positions) != len(times):
        problem = f"{len(positions)} poses at {RATE:g} a second"
        raise ValueError(f"{problem} for a motion that has {len(times)}")
    frames = np.arange(len(motion)) if frames is None else frames
    if len(times) == 1:
        return np.repeat(positions, len(frames), axis=0)
    if np.array_equal(times, np.arange(len(motion))):
        return positions[frames]
    from scipy.interpolate import Akima1DInterpolator  # its import takes longer than a repair

    step = times[1]
    # The curve in these frames depends on three poses before and three poses after them.
    first = max(int(frames[0] / step) - 3, 0)
    end = int(frames[-1] / step) + 5
    near = positions[first:end]
    if end > len(times):
        near = np.concatenate([near, 2 * near[-1:] - near[-2:-1]])
    near_times = step * (first + np.arange(len(near)))
    return Akima1DInterpolator(near_times, near, method="makima")(frames)


class Body:
    """The twenty joints of a motion as features on the mean skeleton, and the conversion back.

    (F, ...) means thirty frames a second, (frames, ...) the file's frames. `UnknownRigError` is
    raised if joints are missing from the rig.

    Parameters
    ----------
    motion : Motion
        Any rate, and any rig in which the twenty joints can be found.
    mean_lengths : (20,) array of float
        Bone lengths of the mean skeleton, in metres; the features describe a person with these.

    Attributes
    ----------
    positions : (F, 20, 3) array
        World positions on the motion's own bones in metres.
    lengths : (20,) array
        Mean length of each of the motion's own bones in metres.
    features : (F, 63) array
        The features on the mean skeleton.
    root : RootTransform
        The root transform of the first frame, on the mean skeleton.
    """

    def __init__(self, motion: Motion, mean_lengths: np.ndarray):
        self.motion = motion
        self.mean_lengths = mean_lengths
        self.positions = body_of(motion)
        self.lengths = bone_lengths(self.positions)
        normalised = change_lengths(self.positions, self.lengths, mean_lengths)
        self.features, self.root = positions_to_features(normalised, RATE)

    def positions_of(self, features: np.ndarray, root: RootTransform | None = None) -> np.ndarray:
        """World positions of features (F, 63) on the motion's own bones, (F, 20, 3) in metres.

        `root` is the transform of the first frame; None means the motion's own.
        """
        on_mean_bones = features_to_positions(features, root or self.root)
        return change_lengths(on_mean_bones, self.mean_lengths, self.lengths)

    def to_rig(self, features: np.ndarray, root: RootTransform | None = None) -> Motion:
        """The motion, changed so that its twenty joints follow features.

        Parameters
        ----------
        features : (F, 63) array of float
            At 30 frames a second on the mean skeleton. If they have fewer frames than the motion,
            the motion is truncated; they may not have more.
        root : RootTransform, optional
            The root transform of the first frame; by default the motion's own.

        Returns
        -------
        Motion
            With the skeleton, rate and unit of the motion. Joints beyond the twenty keep their
            rotation relative to their parent.
        """
        motion = self.motion
        source = motion.source_frames(RATE)
        if len(features) != len(source):
            motion = motion.at(slice(int(np.ceil(source[len(features)]))))
        # Below 30 frames a second the last pose can lie after the last frame.
        poses = self.positions_of(features, root)[: len(motion.source_frames(RATE))]
        return retarget_poses(motion, poses)


def retarget_poses(motion: Motion, poses: np.ndarray) -> Motion:
    """The motion, changed so that its twenty joints follow poses (F, 20, 3) at `RATE`."""
    return retarget(motion, partial(at_rate_of, motion, poses))


def hold_first_pose(motion: Motion, frames: int) -> Motion:
    """The first pose of a motion, held for at least `frames` frames at 30 a second."""
    held = np.zeros(int(np.ceil((frames + 1) * motion.rate / RATE)) + 1, dtype=int)
    return motion.at(held)
