"""Clips of any length: whole takes on jang2018's manifold, in clips that overlap and are blended,
beside clips that are glued together.

What is looked for is the seam: the acceleration of joints in the two frames where one clip ends
and the next begins, over that everywhere else.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold.long_sequences import project_sequence, starts
from numpy_cae.motion import (
    ANGLE_RATE,
    PARENTS,
    POSITIONS,
    AngleSequence,
    body_positions,
    positions_to_features,
)
from numpy_cae.motion.angles import motion_of
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, save_figure, save_gif, strip_figure

TAKES, LONGEST = 12, 250
"""Takes of at most ten seconds."""
SEAMLESS = 1.1
"""A seam that jumps so much more than the rest counts as one."""
REAL, GLUED, BLENDED = "the take itself", "clips glued together", "overlapping clips, blended"


@dataclass(frozen=True)
class Row:
    """Pose error, cm; acceleration in m/s², away from seams, and at them over that."""

    error: float
    elsewhere: float
    seam: float


@dataclass(frozen=True)
class SequenceLong:
    """The table, and one take's positions (F, 20, 3) by method."""

    action: str
    rows: dict[str, Row]
    takes: int
    shown: dict[str, np.ndarray]

    @property
    def title(self) -> str:
        """What is told."""
        return f"Whole takes of {self.action} on jang2018's manifold"

    def text(self) -> str:
        """For a terminal."""
        rows = [
            [name, f"{row.error:.2f}", f"{row.elsewhere:.2f}", f"{row.seam:.2f}"]
            for name, row in self.rows.items()
        ]
        header = ["motion", "pose error, cm", "acceleration, m/s²", "at seams / elsewhere"]
        return f"{self.takes} held-out takes:\n\n{text_table(header, rows)}"

    def findings(self) -> list[Finding]:
        """Whether there is a seam."""
        glued, blended = self.rows[GLUED], self.rows[BLENDED]
        return [
            Finding(
                f"Overlapping decodings of {self.action}, blended, have no seam: where clips begin "
                f"and end joints accelerate at most {SEAMLESS} times as much as elsewhere (not in "
                "jang2018, whose clips are 50 frames).",
                blended.seam <= SEAMLESS,
                f"{blended.seam:.2f} times; glued together {glued.seam:.2f} times.",
            )
        ]

    def save_picture(self, path: str | Path) -> None:
        """Strips of one take."""
        save_figure(strip_figure(self._actors(), ANGLE_RATE, azimuth=75.0), path)

    def save_gif(self, path: str | Path) -> None:
        """The same, moving."""
        save_gif(self._actors(), path, ANGLE_RATE, fps=12.5, azimuth=75.0)

    def _actors(self) -> list[Actor]:
        colours = {REAL: TRUTH, GLUED: CORRUPTED, BLENDED: PROJECTED}
        return [Actor(x, PARENTS, name, colours[name]) for name, x in self.shown.items()]


def long_takes(study: Study) -> SequenceLong:
    """Project held-out takes whole.

    Parameters
    ----------
    study : Study

    Raises
    ------
    ValueError
        If no held-out take has three clips.
    """
    frames, takes = study.manifold.settings["frames"], long_enough(study)
    if not takes:
        raise ValueError(f"no held-out take has {3 * frames} frames")
    measured, shown = {REAL: [], GLUED: [], BLENDED: []}, {}
    for take in takes:
        # Whole clips alone, so that both have their seams in the same frames.
        most = min(len(take), LONGEST) // frames * frames
        cut = AngleSequence(take.numbers[:most], take.table, study.manifold.offsets)
        motions = {
            REAL: body_positions(motion_of(cut.numbers, cut.table, cut.offsets)),
            GLUED: np.concatenate([_projected(study, cut, t, frames)
                                   for t in range(0, most, frames)]),
            BLENDED: body_positions(project_sequence(study.manifold, cut)),
        }  # fmt: skip
        shown = shown or motions
        for name, positions in motions.items():
            overlapping = starts(most, frames)[1:]
            begin = overlapping if name == BLENDED else overlapping[1::2]
            measured[name].append(_row(positions, motions[REAL], begin))
    rows = {name: Row(*np.mean(each, axis=0)) for name, each in measured.items()}
    return SequenceLong(study.action.name, rows, len(takes), shown)


def long_enough(study: Study) -> list[AngleSequence]:
    """Held-out takes of three clips or more, `TAKES` at most."""
    least = 3 * study.manifold.settings["frames"]
    return [take for take in study.action.testing if len(take) >= least][:TAKES]


def _projected(study: Study, take: AngleSequence, first: int, frames: int) -> np.ndarray:
    numbers = take.numbers[first : first + frames]
    piece = AngleSequence(numbers, take.table, take.offsets)
    return body_positions(project_sequence(study.manifold, piece))


def _row(positions: np.ndarray, truth: np.ndarray, begin: np.ndarray) -> tuple[float, ...]:
    gap = _poses(positions) - _poses(truth)
    acceleration = np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1).mean(axis=1)
    acceleration *= ANGLE_RATE**2
    # Frame t is in the middle of acceleration t - 1.
    at = np.zeros(len(acceleration), bool)
    at[[t - 1 for t in begin] + [t - 2 for t in begin]] = True
    elsewhere = acceleration[~at].mean()
    return 100 * np.sqrt(np.mean(gap**2)), elsewhere, acceleration[at].mean() / elsewhere


def _poses(positions: np.ndarray) -> np.ndarray:
    return positions_to_features(positions, ANGLE_RATE)[0][:, POSITIONS]
