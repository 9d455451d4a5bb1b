"""Train and measure every row of the ablation, from several seeds.

"We also wish to thoroughly evaluate our work against alternative methods and justify the
effectiveness of using a deep architecture" (holden2015, section 7). A seed sets the first weights,
the order, the corruption and the lost values of the test, equally for all rows, so that rows are
compared seed by seed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.experiments.ablation import choices as rows_of
from numpy_cae.experiments.ablation.choices import LATENT, PARAMETERS, SEEDS, Choice
from numpy_cae.experiments.ablation.evaluation import MEASURES, Evaluation, Measured, baselines
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.training import DivergedError, train_autoencoder
from numpy_cae.viz import PLAIN, PROJECTED, dots_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


REPAIR, RECONSTRUCTION = "half_zeroed", "reconstruction"
PAPER_CHOICES = {
    rows_of.NO_SPARSITY: ("the sparsity term with α = 0.01", "none"),
    rows_of.UNTIED: ("tied weights", "untied ones"),
    rows_of.AVERAGE: ("pooling by the maximum", "the mean"),
    rows_of.EVENLY: ("unpooling at random while a layer is trained", "evenly"),
    rows_of.WHOLE: ("denoising with p = 0.1", "none"),
    rows_of.LAYERS_ALONE: ("fine tuning after the layers", "none"),
    rows_of.AT_ONCE: ("training layer by layer first", "end to end alone"),
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
        values = [each[measure] for each in self.measured if each]
        return float(np.mean(values)) if values else np.nan

    def cell(self, measure: str) -> str:
        """Mean ± standard deviation over the seeds that did not diverge."""
        values = self.values(measure)
        values, diverged = values[np.isfinite(values)], self.measured.count(None)
        if not len(values):
            return "diverged" if diverged else "–"
        _, digits = MEASURES[measure]
        spread = f" ± {values.std(ddof=1):.{digits}f}" if len(values) > 1 else ""
        note = f" ({diverged} diverged)" if diverged else ""
        return f"{values.mean():.{digits}f}{spread}{note}"


def measure_rows(
    evaluation: Evaluation,
    choices: Sequence[Choice],
    seeds: int = SEEDS,
    progress: Callable[[str], None] = lambda line: None,
) -> list[Row]:
    """Train and measure every choice and every baseline, all of them from one seed after another.

    The paper's choice is the first. `progress` gets a line of text after each measurement.
    """
    rows = [Row(choice.name, choice.parameters, choice.latent) for choice in choices]
    measures = [partial(_train_and_measure, evaluation, choice) for choice in choices]
    for name, repair in baselines(evaluation.split).items():
        rows.append(Row(name))
        measures.append(partial(evaluation.measure, repair))
    for seed in range(seeds):
        for row, measure in zip(rows, measures, strict=True):
            last = measure(seed)
            row.measured.append(last)
            status = f"half zeroed {last['half_zeroed']:.2f} cm" if last else "diverged"
            progress(f"seed {seed}: {row.name}: {status}")
    return rows


def _train_and_measure(evaluation: Evaluation, choice: Choice, seed: int) -> Measured | None:
    """None where training diverges."""
    rng = np.random.default_rng(seed)
    network = choice.network(rng)
    try:
        train_autoencoder(network, evaluation.windows, choice.schedule, rng, show_progress=False)
    except DivergedError:
        return None
    manifold = evaluation.manifold(network, choice.schedule.fine_tuning.rescaled)
    hidden = network.encode(evaluation.split.testing.x)
    return evaluation.measure(manifold.project_windows, seed, hidden)


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
    return [*claims, _claim(adam, named[rows_of.ADAM_LAYERS], named[rows_of.ADAM_AT_ONCE])]


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
