"""The measures of valid human motion together.

holden2015 says of interpolation that it "creates motion which remains valid" (section 7) and of Φ†
that it "always produces" motion "within the subspace of valid human motion" (section 3), without a
definition of valid. Here: bones keep their lengths, a standing foot does not slide, joints stay
within the range of real motions, accelerations are as large as in real motion, and each pose is
near a real one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np

from numpy_cae.measures.bone_length_error import bone_length_error
from numpy_cae.measures.foot_sliding import foot_sliding
from numpy_cae.measures.jitter import jitter
from numpy_cae.measures.joint_limits import JointLimits, beyond_limits
from numpy_cae.measures.nearest_pose import NearestPose
from numpy_cae.motion.features import FEATURES, POSITIONS, features_to_positions


@dataclass(frozen=True)
class Validity:
    """The measures of one motion, or their means over several.

    Parameters
    ----------
    bone_length : float
        `bone_length_error`, cm.
    foot_sliding : float
        cm/s.
    beyond_limits : float
        Per cent of the frames.
    jitter : float
        m/s².
    nearest_pose : float
        cm.
    """

    bone_length: float
    foot_sliding: float
    beyond_limits: float
    jitter: float
    nearest_pose: float

    HEADER = (
        "bone length, cm",
        "foot sliding, cm/s",
        "beyond limits, %",
        "jitter, m/s²",
        "nearest pose, cm",
    )

    FORMATS = ("", ".2f", ".1f", ".1f", ".2f", ".2f")
    """Of a table's columns: a name, then the measures."""

    def against(self, other: Validity) -> str:
        """Each measure beside that of another motion, in a sentence."""
        columns = zip(self.HEADER, self.FORMATS[1:], astuple(self), astuple(other), strict=True)
        return "; ".join(f"{name} {a:{form}} against {b:{form}}" for name, form, a, b in columns)

    @classmethod
    def mean(cls, measured: Sequence[Validity]) -> Validity:
        """The mean of each measure over motions."""
        return cls(*np.mean([astuple(one) for one in measured], axis=0).tolist())


class ValidityMeasure:
    """Measures motions by the joint limits and poses of real ones.

    Parameters
    ----------
    real : sequence of (F, 63) arrays of float
        Features of real motions, on the same bones as the motions to measure.
    lengths : (20,) array of float
        The bones' lengths, metres.
    rate : float
        Frames a second.
    """

    def __init__(self, real: Sequence[np.ndarray], lengths: np.ndarray, rate: float):
        frames = np.concatenate(list(real))
        self.lengths, self.rate = lengths, rate
        self.limits = JointLimits.of_poses(frames[:, POSITIONS].reshape(len(frames), -1, 3))
        self.nearest = NearestPose(frames)

    def of(self, features: np.ndarray) -> Validity:
        """Measure one motion, (F, 63) features of at least 3 frames."""
        if np.ndim(features) != 2 or np.shape(features)[1] != FEATURES:
            raise ValueError(f"features have shape {np.shape(features)}, expected (frames, 63)")
        positions = features_to_positions(features)
        return Validity(
            bone_length_error(positions, self.lengths),
            foot_sliding(positions, self.rate),
            beyond_limits(positions, self.limits),
            jitter(positions, self.rate),
            self.nearest.mean_distance(features),
        )
