"""The measures of valid human motion together.

holden2015 says of interpolation that it "creates motion which remains valid" (section 7) and of Φ†
that it "always produces" motion "within the subspace of valid human motion" (section 3), without a
definition of valid. Here: bones keep their lengths, a standing foot does not slide, accelerations
are as large as in real motion, and each pose is near a real one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass

import numpy as np

from numpy_cae.evaluation import jitter
from numpy_cae.evaluation.tables import Table
from numpy_cae.motion.contacts import foot_sliding
from numpy_cae.motion.features import POSITIONS, features_to_positions, frame_lengths

MAX_POSES = 12_000
"""Real poses kept; neighbouring frames are nearly equal."""


def bone_length_error(positions: np.ndarray, lengths: np.ndarray) -> float:
    """Root mean square over bones and frames of the deviation from `lengths` (20,), centimetres.

        100 · √ mean_{t,j} (‖p_{t,j} - p_{t,parent(j)}‖ - l_j)²

    holden2015, section 7, names it as a limitation: "the manifold projection cannot guarantee
    constraints such as ground contact and joint lengths". Real bodies have an error too, where a
    bone spans joints that bend (the neck, between chest and head).
    """
    gap = (frame_lengths(np.asarray(positions, dtype=np.float64)) - lengths)[:, 1:]
    return float(100 * np.sqrt(np.mean(gap**2)))


@dataclass(frozen=True)
class Validity:
    """The measures of one motion, or their means over several.

    Parameters
    ----------
    bone_length : float
        `bone_length_error`, cm.
    foot_sliding : float
        cm/s.
    jitter : float
        m/s².
    nearest_pose : float
        cm.
    """

    bone_length: float
    foot_sliding: float
    jitter: float
    nearest_pose: float

    HEADER = ("bone length, cm", "foot sliding, cm/s", "jitter, m/s²", "nearest pose, cm")
    FORMATS = ("", ".2f", ".1f", ".2f", ".2f")
    """Of a table's columns: a name, then the measures."""

    def against(self, opponent: Validity) -> str:
        """Each measure beside that of another motion, in a sentence."""
        columns = zip(self.HEADER, self.FORMATS[1:], astuple(self), astuple(opponent), strict=True)
        return "; ".join(f"{name} {a:{form}} against {b:{form}}" for name, form, a, b in columns)

    def listed(self) -> str:
        """Each measure, in a sentence."""
        columns = zip(self.HEADER, self.FORMATS[1:], astuple(self), strict=True)
        return "; ".join(f"{name} {value:{form}}" for name, form, value in columns)

    @classmethod
    def mean(cls, measured: Sequence[Validity]) -> Validity:
        """The mean of each measure over motions."""
        return cls(*np.mean([astuple(validity) for validity in measured], axis=0).tolist())


class ValidityMeasure:
    """Measures motions, comparing their poses with real ones.

    Parameters
    ----------
    real : sequence of (F, 63) arrays of float
        Features of real motions, on the same bones as the motions to measure. At most `MAX_POSES`
        of their poses, evenly spread, are kept.
    lengths : (20,) array of float
        The bones' lengths, metres.
    rate : float
        Frames a second.
    """

    def __init__(self, real: Sequence[np.ndarray], lengths: np.ndarray, rate: float):
        from scipy.spatial import cKDTree  # slow to import, and seldom used

        self.lengths = lengths
        self.rate = rate
        poses = np.concatenate(list(real)).astype(np.float64)[:, POSITIONS]
        self._tree = cKDTree(poses[:: -(-len(poses) // MAX_POSES)])

    def of(self, features: np.ndarray) -> Validity:
        """Measure one motion, (F, 63) features of at least 3 frames."""
        positions = features_to_positions(features)
        return Validity(
            bone_length_error(positions, self.lengths),
            foot_sliding(positions, self.rate),
            jitter(positions, self.rate),
            float(self.nearest_distances(features).mean()),
        )

    def mean(self, clips: Sequence[np.ndarray]) -> Validity:
        """The mean of each measure over motions."""
        return Validity.mean(self.each(clips))

    def each(self, clips: Sequence[np.ndarray]) -> list[Validity]:
        """The measures of each motion."""
        return [self.of(clip) for clip in clips]

    def nearest_distances(self, features: np.ndarray) -> np.ndarray:
        """The distance of every frame (F, 63) to the nearest of the real poses, cm, (F,).

            d_t = 100 · min_i √ mean_k (q_{t,k} - q_{i,k})²

        over the 60 position features, local to the body's place on the floor and its heading: the
        smallest `position_error` of each frame to a real pose.
        """
        poses = np.asarray(features, dtype=np.float64)[:, POSITIONS]
        distance, _ = self._tree.query(poses)
        return 100 * distance / np.sqrt(poses.shape[1])


def validity_table(caption: str, measured: Mapping[str, Validity]) -> Table:
    """A row for each kind of motion, with its name."""
    rows = [[name, *astuple(validity)] for name, validity in measured.items()]
    return Table(caption, ["motion", *Validity.HEADER], rows, Validity.FORMATS)
