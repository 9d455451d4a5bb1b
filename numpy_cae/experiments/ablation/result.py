"""What an ablation found: its table, its picture, its claims and two sentences."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from numpy_cae.experiments.ablation.baselines import BASELINES, LINEAR
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
from numpy_cae.experiments.ablation.evaluation import Measured
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.table import text_table
from numpy_cae.viz import PLAIN, PROJECTED, save_figure

HALF, WHOLE_CLIPS, POSE, SAME = "half_zeroed", "reconstruction", "nearest_pose", "content"
_FIELDS = tuple(Measured.__dataclass_fields__)
_SHOWN = {
    HALF: "half zeroed, cm",
    WHOLE_CLIPS: "reconstruction, cm",
    POSE: "between two motions: nearest pose, cm",
    SAME: "retrieval of the same content, mAP",
}
_CHOICES = (
    (NO_SPARSITY, "the sparsity term, α = 0.01 against none"),
    (UNTIED, "tied weights against untied ones"),
    (AVERAGE, "pooling by the maximum against the mean"),
    (EVENLY, "unpooling at random while a layer is trained against evenly"),
    (WHOLE, "denoising with p = 0.1 against none"),
    (LAYERS_ALONE, "fine tuning after the layers against none"),
    (AT_ONCE, "training layer by layer first against end to end alone"),
)
"""What of the paper's is weighed against leaving it out."""


@dataclass(frozen=True)
class Row:
    """One line of the table: `measured` seed by seed, None where training diverged."""

    group: str
    name: str
    parameters: int | None = None
    latent: int | None = None
    measured: list[Measured | None] = field(default_factory=list)

    def of(self, measure: str) -> np.ndarray:
        """A measure by seed, (S,); not a number where there is none."""
        return np.array([getattr(each, measure) if each else np.nan for each in self.measured])

    def said(self) -> str:
        """Its last measurement in a line."""
        last = self.measured[-1]
        found = "diverged" if last is None else f"half zeroed {last.half_zeroed:.2f} cm"
        return f"{self.name}: {found}"

    def cell(self, measure: str) -> str:
        """Mean ± standard deviation over the seeds that did not diverge."""
        values = self.of(measure)
        values = values[np.isfinite(values)]
        if not len(values):
            return "–"
        digits = Measured.DIGITS[_FIELDS.index(measure)]
        spread = f" ± {values.std(ddof=1):.{digits}f}" if len(values) > 1 else ""
        lost = sum(each is None for each in self.measured)
        return f"{values.mean():.{digits}f}{spread}" + (f" ({lost} diverged)" if lost else "")


@dataclass(frozen=True)
class Ablation:
    """Every row, the paper's network first, and what they were measured on."""

    rows: list[Row]
    sample: str
    title: str = "Depth, sparsity, pooling, tying, denoising: which of them earns it?"

    def row(self, name: str) -> Row:
        """The row of a name."""
        return next(row for row in self.rows if row.name == name)

    @property
    def paper(self) -> Row:
        """The row that all others are compared with."""
        return self.rows[0]

    def text(self) -> str:
        """The finding in two sentences, then one table."""
        header = ["method", "parameters", "hidden", *Measured.HEADER]
        lines = [
            [
                f"{row.group}: {row.name}",
                *(f"{n}" if n else "–" for n in (row.parameters, row.latent)),
                *(row.cell(measure) for measure in _FIELDS),
            ]
            for row in self.rows
        ]
        seeds = len(self.paper.measured)
        return (
            f"{self.on_depth()}\n{self.on_the_rest()}\n\n"
            f"Mean ± standard deviation of {seeds} seeds; of a baseline, which learns nothing at "
            "random, of the lost values alone. Hidden: numbers in the highest layer for a window "
            "of 160 frames. Between two motions: five measures of validity, and of jitter the "
            "most natural value is the motions' own. Every row but the first differs from it in "
            f"what it is named for. {self.sample}\n\n"
            f"{text_table(header, lines)}"
        )

    def on_depth(self) -> str:
        """The first of two sentences: whether depth is worth it."""
        parts = []
        for same in (LATENT, PARAMETERS):
            rows = [self.row(f"depth {depth}, {same}") for depth in (1, 2)]
            errors = ", ".join(f"{depth}: {row.cell(HALF)}" for depth, row in enumerate(rows, 1))
            parts.append(
                f"at {same} ({errors}) three layers repair "
                + " and ".join(
                    f"{self._better(row, HALF)} {'one' if depth == 1 else 'two'}"
                    for depth, row in enumerate(rows, 1)
                )
                + f" and reconstruct {self._better(rows[0], WHOLE_CLIPS)} one"
            )
        return (
            f"Depth: of half zeroed clips three layers leave {self.paper.cell(HALF)} cm; "
            f"{'; '.join(parts)}."
        )

    def on_the_rest(self) -> str:
        """The second: what else matters, and what a linear map does."""
        tried = [self.row(name) for name, _ in _CHOICES]
        told = {True: [], False: []}
        for row, (_, words) in zip(tried, _CHOICES, strict=True):
            certain = self._verdict(row, HALF) != 0
            change = np.nanmean(row.of(HALF)) / np.nanmean(self.paper.of(HALF)) - 1
            told[certain].append((-abs(change), f"{words.split(' against ')[0]} ({change:+.0%})"))
        matter, open_ = ([text for _, text in sorted(told[key])] for key in (True, False))
        return (
            "The rest: left out or replaced, these change the error of repair with one sign in "
            f"every seed: {', '.join(matter) or 'none'}; these do not: "
            f"{', '.join(open_) or 'none'}; a linear map of 15 frames leaves "
            f"{self.row(LINEAR).cell(HALF)} cm."
        )

    def findings(self) -> list[Finding]:
        """What the paper leaves to be justified, weighed by repair."""
        deep = [
            self._finding(
                f"The deep architecture is effective (holden2015, section 7, leaves it to be "
                f"justified): three layers repair better than {number}, {same}.",
                self.row(f"depth {depth}, {same}"),
            )
            for same in (LATENT, PARAMETERS)
            for depth, number in ((1, "one"), (2, "two"))
        ]
        return deep + [
            self._finding(f"The paper's choice repairs better: {words}.", self.row(name))
            for name, words in _CHOICES
        ]

    def _finding(self, claim: str, other: Row) -> Finding:
        figures = "; ".join(
            f"{shown} {self.paper.cell(measure)} against {other.cell(measure)}"
            for measure, shown in _SHOWN.items()
        )
        return Finding(
            claim,
            self._verdict(other, HALF) > 0,
            f"{figures}. Held means a smaller error of repair in every seed.",
        )

    def _verdict(self, other: Row, measure: str) -> int:
        """1 where the paper's network has the smaller error in every seed, -1 where the other
        has, else 0; a seed that diverged has lost."""
        one, two = (np.nan_to_num(row.of(measure), nan=np.inf) for row in (self.paper, other))
        return int(np.all(one < two)) - int(np.all(one > two))

    def _better(self, other: Row, measure: str) -> str:
        words = {1: "better than", 0: "neither surely better nor worse than", -1: "worse than"}
        return words[self._verdict(other, measure)]

    def save_picture(self, path: str | Path) -> None:
        """Four measures, a dot a seed and a line at the mean, PNG."""
        figure = Figure(figsize=(14, 0.3 * len(self.rows) + 1.4), layout="constrained")
        all_axes = figure.subplots(1, len(_SHOWN), sharey=True)
        places = np.arange(len(self.rows))
        for axes, (measure, shown) in zip(all_axes, _SHOWN.items(), strict=True):
            axes.axvline(np.nanmean(self.paper.of(measure)), color="#d0d0d0", linewidth=1, zorder=0)
            for place, row in zip(places, self.rows, strict=True):
                values = row.of(measure)
                colour = PLAIN if row.group == BASELINES else PROJECTED
                axes.plot(values, np.full(len(values), place), "o", color=colour, alpha=0.4, ms=4)
                if np.isfinite(values).any():
                    axes.plot(np.nanmean(values), place, "|", color=colour, ms=12, mew=2)
            axes.set_title(shown, fontsize=9, loc="left")
            axes.grid(axis="y", color="#eeeeee", linewidth=0.6)
            axes.spines[["top", "right"]].set_visible(False)
        all_axes[0].set_yticks(places, [row.name for row in self.rows], fontsize=8)
        all_axes[0].invert_yaxis()
        save_figure(figure, path)
