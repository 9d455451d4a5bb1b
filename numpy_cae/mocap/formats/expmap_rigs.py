"""The two layouts of exponential-map text in the literature on motion prediction.

A line is a frame: three numbers for the root's translation, then three for each joint of the rig
and for each tip of a bone, in the order of `expmap_rigs.json`. The layouts are those of Jain et al.
(2016) and MBR17 (Martinez, Black, Romero, 2017); the bone lengths of Human3.6M are those that MBR17
draws with. The CMU text has no bone lengths: these are subject 02's.
"""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from numpy_cae.mocap.units import CMU_UNIT
from numpy_cae.motion.motion import Skeleton


@dataclass(frozen=True)
class ExpmapRig:
    """One layout: its name, the metres in one unit of its lengths, and the frames a second of text
    in this layout."""

    name: str
    unit: float
    rate: float

    @cached_property
    def rows(self) -> list[list]:
        """(joint, its parent, offset from the parent, optional tip) in the order of the text. The
        tip is an offset from the joint; if a row has one, the text holds three zeros for it after
        the joint's own numbers."""
        file = Path(__file__).with_suffix(".json")
        return json.loads(file.read_text(encoding="utf-8"))[self.name]

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


CMU = ExpmapRig("CMU", CMU_UNIT, rate=120.0)
HUMAN36M = ExpmapRig("Human3.6M", 0.001, rate=50.0)
EXPMAP_RIGS = (CMU, HUMAN36M)
