"""The result of an ablation: two sentences, one table, the claims and a figure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.experiments.ablation.baselines import LINEAR
from numpy_cae.experiments.ablation.choices import (
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
from numpy_cae.viz import PLAIN, PROJECTED

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

    def status(self) -> str:
        """The last measurement in a line."""
        last = self.measured[-1]
        return f"{self.name}: " + (f"half zeroed {last[REPAIR]:.2f} cm" if last else "diverged")

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
    """Compare every row with the first, the paper's network.

    Parameters
    ----------
    rows : sequence of Row
    sample : str
        What was measured on, in a sentence.
    """
    named = {row.name: row for row in rows}
    header = ["method", "parameters", "hidden", *(heading for heading, _ in MEASURES.values())]
    lines = [
        [
            row.name,
            row.parameters or "–",
            row.latent or "–",
            *(row.cell(measure) for measure in MEASURES),
        ]
        for row in rows
    ]
    note = (
        f"Mean ± standard deviation of {len(rows[0].measured)} seeds; for a baseline, which learns "
        "nothing at random, over the lost values alone. Hidden: numbers in the highest layer for a "
        "window of 160 frames. Every row differs from the first in what it is named after. "
        f"{sample}"
    )
    title = "Ablation: depth, sparsity, pooling, tied weights, denoising and training"
    sentences = f"{_on_depth(rows[0], named)}\n{_on_the_rest(rows[0], named)}"
    table = Table(sentences, header, lines)
    return Result(title, [table], _claims(rows[0], named), lambda: _draw(rows), note=note)


def _verdict(paper: Row, other: Row, measure: str = REPAIR) -> int:
    """1 if the paper's network has the smaller error in every seed, -1 if the larger, else 0.

    A seed that diverged counts as an infinite error.
    """
    one, two = (np.nan_to_num(row.values(measure), nan=np.inf) for row in (paper, other))
    return int(np.all(one < two)) - int(np.all(one > two))


def _on_depth(paper: Row, named: dict[str, Row]) -> str:
    """The first sentence: whether depth reduces the error of repair."""
    words = {1: "better than", 0: "neither surely better nor worse than", -1: "worse than"}
    parts = []
    for same in (LATENT, PARAMETERS):
        one, two = (named[f"depth {depth}, {same}"] for depth in (1, 2))
        parts.append(
            f"at {same} (1: {one.cell(REPAIR)}, 2: {two.cell(REPAIR)}) three layers repair "
            f"{words[_verdict(paper, one)]} one and {words[_verdict(paper, two)]} two and "
            f"reconstruct {words[_verdict(paper, one, RECONSTRUCTION)]} one"
        )
    return (
        f"Depth: on half zeroed clips three layers leave {paper.cell(REPAIR)} cm; "
        f"{'; '.join(parts)}."
    )


def _on_the_rest(paper: Row, named: dict[str, Row]) -> str:
    """The second sentence: which other choices matter, and the error of a linear map."""
    certain, open_ = [], []
    error = paper.mean(REPAIR)
    changes = {name: named[name].mean(REPAIR) / error - 1 for name in PAPER_CHOICES}
    for name in sorted(changes, key=lambda name: -np.nan_to_num(abs(changes[name]), nan=np.inf)):
        amount = f"{changes[name]:+.0%}" if np.isfinite(changes[name]) else "diverged"
        names = certain if _verdict(paper, named[name]) else open_
        names.append(f"{PAPER_CHOICES[name][0]} ({amount})")
    return (
        "The rest: left out or replaced, these change the error of repair with one sign in every "
        f"seed: {', '.join(certain) or 'none'}; these do not: {', '.join(open_) or 'none'}; a "
        f"linear map of 15 frames leaves {named[LINEAR].cell(REPAIR)} cm."
    )


def _claims(paper: Row, named: dict[str, Row]) -> list[Claim]:
    sentences = {
        f"depth {depth}, {same}": "The deep architecture is effective (holden2015, section 7, "
        f"leaves it to be justified): three layers repair better than {number}, {same}."
        for same in (LATENT, PARAMETERS)
        for depth, number in ((1, "one"), (2, "two"))
    }
    for name, (choice, alternative) in PAPER_CHOICES.items():
        sentences[name] = f"The paper's choice repairs better: {choice} against {alternative}."
    claims = []
    for name, sentence in sentences.items():
        figures = "; ".join(
            f"{MEASURES[measure][0]} {paper.cell(measure)} against {named[name].cell(measure)}"
            for measure in (REPAIR, RECONSTRUCTION)
        )
        held = _verdict(paper, named[name]) > 0
        claims.append(
            Claim(sentence, held, f"{figures}. Held: a smaller error of repair in every seed.")
        )
    return claims


def _draw(rows: Sequence[Row]) -> Figure:
    """Both errors, a dot for each seed and a line at the mean."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 0.3 * len(rows) + 1.4), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for axes, measure in zip(panels, (REPAIR, RECONSTRUCTION), strict=True):
        axes.axvline(rows[0].mean(measure), color="#d0d0d0", linewidth=1, zorder=0)
        for y, row in enumerate(rows):
            values = row.values(measure)
            colour = PROJECTED if row.parameters else PLAIN
            axes.plot(values, np.full(len(values), y), "o", color=colour, alpha=0.4, ms=4)
            axes.plot(row.mean(measure), y, "|", color=colour, ms=12, mew=2)
        axes.set_title(MEASURES[measure][0], fontsize=9, loc="left")
        axes.grid(axis="y", color="#eeeeee", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_yticks(np.arange(len(rows)), [row.name for row in rows], fontsize=8)
    panels[0].invert_yaxis()
    return figure
