"""What jang2018 only shows of its samples, measured beside real clips.

near       the mean distance to the nearest held-out clip, over that of real training clips
told       the accuracy of a 1-nearest-neighbour two-sample test against held-out clips; 50% is
           perfect
diversity  the mean distance between two samples, over that between two held-out clips
stride     of walking, strides a second: the median, over that of held-out clips
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequences.figure_3 import FITTED, PRIOR, REAL, sampled
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.experiments.table import text_table
from numpy_cae.measures import (
    diversity,
    gait_frequency,
    nearest_distance,
    nearest_neighbour_accuracy,
)
from numpy_cae.motion import body_positions

WALKING = ("walking", "walking_dog", "walking_extra")
SAMPLES = 100
"""From each source."""
STRIDE, TOLD = 0.10, 0.75
"""How far the stride may be off, and the accuracy of the test, for samples of walking."""


@dataclass(frozen=True)
class Row:
    """Samples of one action from one source; ratios to real clips."""

    action: str
    source: str
    near: float
    told: float
    diversity: float
    stride: float
    strides: float


@dataclass(frozen=True)
class SequenceSamples:
    """The table."""

    rows: list[Row]
    periodic: dict[str, bool]
    title: str = "Samples of jang2018's manifolds beside real clips"

    def row(self, action: str, source: str) -> Row:
        """One of them."""
        return next(row for row in self.rows if (row.action, row.source) == (action, source))

    def text(self) -> str:
        """For a terminal."""
        header = ["samples from", "near", "told apart", "diversity", "stride / real", "1/s"]
        rows = [
            [
                f"{row.action}: {row.source}",
                f"{row.near:.2f}",
                f"{row.told:.0%}",
                f"{row.diversity:.2f}",
                _or_nothing(row.stride),
                _or_nothing(row.strides),
            ]
            for row in self.rows
        ]
        return text_table(header, rows)

    def findings(self) -> list[Finding]:
        """The claims about samples."""
        found = []
        if "walking" in self.periodic:
            row = self.row("walking", FITTED)
            found.append(
                Finding(
                    "Samples of walking show a walking pattern (jang2018, Results; here: their "
                    "median stride within 10% of real ones').",
                    abs(row.stride - 1) <= STRIDE,
                    f"{row.strides:.2f} strides a second, {row.stride:.2f} of real clips'.",
                )
            )
            found.append(
                Finding(
                    "Samples of walking can hardly be told from real clips (here: below 75%).",
                    row.told < TOLD,
                    f"{row.told:.0%} are told apart; from the prior itself "
                    f"{self.row('walking', PRIOR).told:.0%}.",
                )
            )
        alike = [self.row(a, FITTED).diversity for a, repeats in self.periodic.items() if repeats]
        other = [
            self.row(a, FITTED).diversity for a, repeats in self.periodic.items() if not repeats
        ]
        if alike and other:
            found.append(
                Finding(
                    "Samples of a periodic action are alike, those of others differ "
                    "(jang2018, Results).",
                    max(alike) < min(other),
                    f"Diversity {max(alike):.2f} of real clips' for the periodic, "
                    + ", ".join(f"{value:.2f}" for value in other)
                    + " for the others.",
                )
            )
        return found


def _or_nothing(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.2f}"


def samples(
    studies: Sequence[Study], seed: int = 0, count: int = SAMPLES
) -> SequenceSamples:
    """Draw from each study's manifold and measure.

    Parameters
    ----------
    studies : sequence of Study
    seed : int
        Of the draws.
    count : int
        Clips from each source.
    """
    rows = []
    for study in studies:
        clips = sampled(study, count, seed)
        held_out, other_real = clips[REAL], study.drawn(count, seed + 1)
        real_near, real_diversity = nearest_distance(other_real, held_out), diversity(held_out)
        walks = study.action.name in WALKING
        real_stride = _strides(study, held_out) if walks else np.nan
        for source, drawn in {**clips, REAL: other_real}.items():
            strides = _strides(study, drawn) if walks else np.nan
            rows.append(
                Row(
                    study.action.name,
                    source,
                    nearest_distance(drawn, held_out) / real_near,
                    nearest_neighbour_accuracy(held_out, drawn),
                    diversity(drawn) / real_diversity,
                    strides / real_stride,
                    strides,
                )
            )
    return SequenceSamples(rows, {s.action.name: s.action.periodic for s in studies})


def _strides(study: Study, clips: np.ndarray) -> float:
    """The median over clips, strides a second; clips in which no one strides do not count."""
    found = [
        gait_frequency(body_positions(study.manifold.motion(clip)), study.manifold.rate)
        for clip in clips
    ]
    return float(np.nanmedian(found)) if np.isfinite(found).any() else float("nan")
