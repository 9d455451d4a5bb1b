"""The two layouts of exponential-map text in the literature on motion prediction.

A line is a frame: three numbers for the root's translation, then three for each joint of the rig
and for each tip of a bone, in the order of the tables below. The layouts are those of Jain et al.
(2016) and MBR17 (Martinez, Black, Romero, 2017); the bone lengths of Human3.6M are those that MBR17
draws with. The CMU text has no bone lengths: these are subject 02's.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from numpy_cae.motion.io.units import CMU_UNIT
from numpy_cae.motion.skeleton import Skeleton


@dataclass(frozen=True)
class ExpmapRig:
    """One layout.

    Parameters
    ----------
    name : str
    rows : tuple of (joint, its parent, offset from the parent, optional tip)
        In the order of the text. A tip, as an offset from the joint, has three more numbers in the
        text after the joint's own, always zero.
    unit : float
        Metres in one unit of the offsets and of the translation.
    rate : float
        Frames a second at which such text is written.
    """

    name: str
    rows: tuple
    unit: float
    rate: float

    @property
    def width(self) -> int:
        """Numbers in a line."""
        return 3 + 3 * sum(len(row) - 2 for row in self.rows)

    @cached_property
    def joints(self) -> np.ndarray:
        """Indices of the joints among all triples of angles, in the order of `skeleton`."""
        widths = [len(row) - 2 for row in self.rows]
        return np.cumsum([0, *widths[:-1]])

    @cached_property
    def skeleton(self) -> Skeleton:
        """The rig in metres."""
        names = tuple(row[0] for row in self.rows)
        return Skeleton(
            names,
            tuple(-1 if row[1] is None else names.index(row[1]) for row in self.rows),
            np.array([row[2] for row in self.rows]) * self.unit,
            {j: np.array(row[3]) * self.unit for j, row in enumerate(self.rows) if len(row) > 3},
        )


CMU = ExpmapRig(
    "CMU",
    (
        ("Hips", None, (0, 0, 0)),
        ("LHipJoint", "Hips", (0, 0, 0)),
        ("LeftUpLeg", "LHipJoint", (1.65674, -1.80282, 0.62477)),
        ("LeftLeg", "LeftUpLeg", (2.5972, -7.13576, 0)),
        ("LeftFoot", "LeftLeg", (2.49236, -6.8477, 0)),
        ("LeftToeBase", "LeftFoot", (0.19704, -0.54136, 2.14581), (0, 0, 1.11249)),
        ("RHipJoint", "Hips", (0, 0, 0)),
        ("RightUpLeg", "RHipJoint", (-1.6107, -1.80282, 0.62476)),
        ("RightLeg", "RightUpLeg", (-2.59502, -7.12977, 0)),
        ("RightFoot", "RightLeg", (-2.4678, -6.78024, 0)),
        ("RightToeBase", "RightFoot", (-0.23024, -0.63258, 2.13368), (0, 0, 1.11569)),
        ("LowerBack", "Hips", (0, 0, 0)),
        ("Spine", "LowerBack", (0.01961, 2.0545, -0.14112)),
        ("Spine1", "Spine", (0.01021, 2.06436, -0.05921)),
        ("Neck", "Spine1", (0, 0, 0)),
        ("Neck1", "Neck", (0.00713, 1.56711, 0.14968)),
        ("Head", "Neck1", (0.03429, 1.56041, -0.10006), (0.01305, 1.6256, -0.05265)),
        ("LeftShoulder", "Spine1", (0, 0, 0)),
        ("LeftArm", "LeftShoulder", (3.54205, 0.90436, -0.17364)),
        ("LeftForeArm", "LeftArm", (4.86513, 0, 0)),
        ("LeftHand", "LeftForeArm", (3.35554, 0, 0)),
        ("LeftFingerBase", "LeftHand", (0, 0, 0)),
        ("LeftHandIndex1", "LeftFingerBase", (0.66117, 0, 0), (0.53306, 0, 0)),
        ("LThumb", "LeftHand", (0, 0, 0), (0.5412, 0, 0.5412)),
        ("RightShoulder", "Spine1", (0, 0, 0)),
        ("RightArm", "RightShoulder", (-3.49802, 0.75994, -0.32616)),
        ("RightForeArm", "RightArm", (-5.02649, 0, 0)),
        ("RightHand", "RightForeArm", (-3.36431, 0, 0)),
        ("RightFingerBase", "RightHand", (0, 0, 0)),
        ("RightHandIndex1", "RightFingerBase", (-0.73041, 0, 0), (-0.58887, 0, 0)),
        ("RThumb", "RightHand", (0, 0, 0), (-0.59786, 0, 0.59786)),
    ),
    unit=CMU_UNIT,
    rate=120.0,
)

HUMAN36M = ExpmapRig(
    "Human3.6M",
    (
        ("Hips", None, (0, 0, 0)),
        ("RightUpLeg", "Hips", (-132.95, 0, 0)),
        ("RightLeg", "RightUpLeg", (0, -442.89, 0)),
        ("RightFoot", "RightLeg", (0, -454.21, 0)),
        ("RightToeBase", "RightFoot", (0, 0, 162.77), (0, 0, 75)),
        ("LeftUpLeg", "Hips", (132.95, 0, 0)),
        ("LeftLeg", "LeftUpLeg", (0, -442.89, 0)),
        ("LeftFoot", "LeftLeg", (0, -454.21, 0)),
        ("LeftToeBase", "LeftFoot", (0, 0, 162.77), (0, 0, 75)),
        ("Spine", "Hips", (0, 0.1, 0)),
        ("Spine1", "Spine", (0, 233.38, 0)),
        ("Neck", "Spine1", (0, 257.08, 0)),
        ("Head", "Neck", (0, 121.13, 0), (0, 115, 0)),
        ("LeftShoulder", "Spine1", (0, 257.08, 0)),
        ("LeftArm", "LeftShoulder", (0, 151.03, 0)),
        ("LeftForeArm", "LeftArm", (0, 278.88, 0)),
        ("LeftHand", "LeftForeArm", (0, 251.73, 0)),
        ("LeftHandThumb", "LeftHand", (0, 0, 0), (0, 0, 100)),
        ("LeftWristEnd", "LeftHand", (0, 100, 0), (0, 0, 0)),
        ("RightShoulder", "Spine1", (0, 257.08, 0)),
        ("RightArm", "RightShoulder", (0, 151.03, 0)),
        ("RightForeArm", "RightArm", (0, 278.89, 0)),
        ("RightHand", "RightForeArm", (0, 251.73, 0)),
        ("RightHandThumb", "RightHand", (0, 0, 0), (0, 0, 100)),
        ("RightWristEnd", "RightHand", (0, 137.5, 0), (0, 0, 0)),
    ),
    unit=0.001,
    rate=50.0,
)

EXPMAP_RIGS = (CMU, HUMAN36M)
