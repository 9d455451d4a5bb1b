"""Joint limits measured on real poses, and the frames that exceed them.

Clinical limits (`data_synth.limits`) are for rotations about the axes of one rig, which positions
of twenty joints do not give. The angles that they give are measured here; the limits are those of
the motion that a manifold was learned from, plus a margin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from numpy_cae.motion.joints import JOINTS, PARENTS

MARGIN = 5.0
"""Degrees beyond the range of the real poses that are still allowed."""
_RARE = 1e-3
"""Share of the poses at either end that does not set a limit: captured motion has outliers."""
_BENT = [j for j, parent in enumerate(PARENTS) if parent > 0 and PARENTS[parent] >= 0]
_KNEES = [JOINTS.index(f"{side}_knee") for side in ("left", "right")]
ANGLES: tuple[str, ...] = (
    *(f"{JOINTS[PARENTS[joint]]} to {JOINTS[joint]}" for joint in _BENT),
    *(f"{JOINTS[knee]} forwards or back" for knee in _KNEES),
)
"""What `bends` measures, in its order."""


def bends(positions: np.ndarray) -> np.ndarray:
    """The angles between bones and the bones above them.

    With b_j = p_j - p_parent(j) the bone that ends at joint j, the angle between two of them

        arccos(b_j · b_parent(j) / ‖b_j‖ ‖b_parent(j)‖)

    which has no sign. Only the knee has one, since it bends back but not forwards: seen along the
    line a from the right hip to the left, the rotation from thigh to shank is

        arctan2((b_thigh × b_shank) · a, b_thigh · b_shank)

    Parameters
    ----------
    positions : (F, 20, 3) array of float

    Returns
    -------
    (F, angles) array of float64
        Degrees, one column for each of `ANGLES`.
    """
    positions = np.asarray(positions, dtype=np.float64)
    bone = positions - positions[:, [max(parent, 0) for parent in PARENTS]]
    above = bone[:, [PARENTS[joint] for joint in _BENT]]
    unsigned = np.arctan2(
        np.linalg.norm(np.cross(above, bone[:, _BENT]), axis=-1),
        np.sum(above * bone[:, _BENT], axis=-1),
    )
    thigh, shank = bone[:, _KNEES], bone[:, [knee + 1 for knee in _KNEES]]
    across = positions[:, JOINTS.index("left_hip")] - positions[:, JOINTS.index("right_hip")]
    across = across / np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-12)
    back = np.arctan2(
        np.sum(np.cross(thigh, shank) * across[:, None], axis=-1), np.sum(thigh * shank, axis=-1)
    )
    return np.degrees(np.concatenate([unsigned, back], axis=-1))


@dataclass(frozen=True)
class JointLimits:
    """The range of each of `ANGLES`, in degrees.

    Parameters
    ----------
    low, high : (angles,) arrays of float
    """

    low: np.ndarray
    high: np.ndarray

    @classmethod
    def of_poses(cls, poses: np.ndarray, margin: float = MARGIN) -> JointLimits:
        """The range of poses (F, 20, 3), without one in a thousand at either end, and a margin."""
        seen = bends(poses)
        low, high = np.quantile(seen, [_RARE, 1 - _RARE], axis=0)
        return cls(low - margin, high + margin)

    def beyond(self, positions: np.ndarray) -> np.ndarray:
        """Where each angle leaves its limits, (F, angles) of bool."""
        angles = bends(positions)
        return (angles < self.low) | (angles > self.high)
