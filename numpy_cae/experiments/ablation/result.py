"""The result of an ablation: one table, the claims and a figure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.experiments.ablation.choices import (
    ADAM_AT_ONCE,
    ADAM_LAYERS,
    AT_ONCE,
    AVERAGE,
    EVENLY,
    LATENT,
    LAYERS_ALONE,
    NO_SPARSITY,
    PARAMETERS,
    UNTIED,
    WHOLE,
)
from numpy_cae.experiments.ablation.evaluation import MEASURES, Measured
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.viz import PLAIN, PROJECTED, dots_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REPAIR, RECONSTRUCTION = "half_zeroed", "reconstruction"
PAPER_CHOICES = {
    NO_SPARSITY: ("the sparsity term with α = 0.01", "none"),
    UNTIED: ("tied weights", "untied ones"),
    AVERAGE: ("pooling by the maximum", "the mean"),
    EVENLY: ("unpooling at random while a layer is trained", "evenly"),
    WHOLE: ("denoising with p = 0.1", "none"),
    LAYERS_ALONE: ("fine tuning after the layers", "none"),
    AT_ONCE: ("training layer by layer first", "end to end alone"),
}
"""A choice of the paper and its alternative, by the row without it."""


@dataclass(frozen=True)
class Row:
    """One line of the table; `measured` has an entry for each seed, None where it diverged.

    `parameters` and `latent`, the number of hidden units of a window, are None for a baseline.
    """

    name: str
    parameters: int | None = None
    latent: int | None = None
    measured: list[Measured | None] = field(default_factory=list)

    def values(self, measure: str) -> np.ndarray:
        """A measure by seed, (S,); nan where there is none."""
        return np.array([each[measure] if each else np.nan for each in self.measured])

    def mean(self, measure: str) -> float:
        """The mean over the seeds that did not diverge; nan if there is none."""
        values = self.values(measure)
        return float(np.mean(values[np.isfinite(values)])) if np.isfinite(values).any() else np.nan

    def cell(self, measure: str) -> str:
        """Mean ± standard deviation over the seeds that did not diverge."""
        values = self.values(measure)
        values = values[np.isfinite(values)]
        diverged = self.measured.count(None)
        if not len(values):
            return "diverged" if diverged else "–"
        _, digits = MEASURES[measure]
        spread = f" ± {values.std(ddof=1):.{digits}f}" if len(values) > 1 else ""
        note = f" ({diverged} diverged)" if diverged else ""
        return f"{values.mean():.{digits}f}{spread}{note}"


def ablation_result(rows: Sequence[Row], sample: str) -> Result:
    """Compare every row with the first, the paper's network; `sample` says what was measured on."""
    header = ["method", "parameters", "hidden", *(heading for heading, _ in MEASURES.values())]
    lines = [
        [row.name, row.parameters or "–", row.latent or "–", *map(row.cell, MEASURES)]
        for row in rows
    ]
    note = (
        f"Mean ± standard deviation of {len(rows[0].measured)} seeds; for a baseline, which learns "
        "nothing at random, over the lost values alone. Hidden: numbers in the highest layer for a "
        "window of 160 frames. Every row differs from the first in what it is named after. "
        f"{sample}"
    )
    title = "Ablation: depth, sparsity, pooling, tied weights, denoising and training"
    table = Table("", header, lines)
    return Result(title, [table], _claims(rows), lambda: _figure(rows), note=note)


def _claims(rows: Sequence[Row]) -> list[Claim]:
    sentences = {
        f"depth {depth}, {same}": "The deep architecture is effective (holden2015, section 7, "
        f"leaves it to be justified): three layers repair better than {number}, {same}."
        for same in (LATENT, PARAMETERS)
        for depth, number in ((1, "one"), (2, "two"))
    }
    for name, (choice, alternative) in PAPER_CHOICES.items():
        sentences[name] = f"The paper's choice repairs better: {choice} against {alternative}."
    named = {row.name: row for row in rows}
    claims = [_claim(sentence, rows[0], named[name]) for name, sentence in sentences.items()]
    adam = "With Adam too, training layer by layer first repairs better than end to end alone."
    return [*claims, _claim(adam, named[ADAM_LAYERS], named[ADAM_AT_ONCE])]


def _claim(sentence: str, paper: Row, other: Row) -> Claim:
    """Whether the paper's choice repairs better in every seed; one that diverged does not."""
    figures = "; ".join(
        f"{MEASURES[measure][0]} {paper.cell(measure)} against {other.cell(measure)}"
        for measure in (REPAIR, RECONSTRUCTION)
    )
    change = other.mean(REPAIR) / paper.mean(REPAIR) - 1
    effect = f"by {change:+.0%}" if np.isfinite(change) else "beyond all bounds"
    one, two = (np.nan_to_num(row.values(REPAIR), nan=np.inf) for row in (paper, other))
    better = int(np.sum(one < two))
    return Claim(
        sentence,
        better == len(one),
        f"{figures}. The alternative changes the error of repair {effect}; the paper's "
        f"choice is better in {better} of {len(one)} seeds (held if in all).",
    )


def _figure(rows: Sequence[Row]) -> Figure:
    return dots_figure(
        [row.name for row in rows],
        [PROJECTED if row.parameters else PLAIN for row in rows],
        {
            MEASURES[measure][0]: [row.values(measure) for row in rows]
            for measure in (REPAIR, RECONSTRUCTION)
        },
    )
