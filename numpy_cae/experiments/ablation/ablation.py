"""Train and measure every row of the ablation, from several seeds.

"We also wish to thoroughly evaluate our work against alternative methods and justify the
effectiveness of using a deep architecture" (holden2015, section 7). A seed sets the first weights,
the order, the corruption and the removed values of the test, equally for all rows, so that rows are
compared seed by seed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from numpy_cae.experiments.ablation import choices as rows_of
from numpy_cae.experiments.ablation.choices import SEEDS, Choice
from numpy_cae.experiments.clips import testing_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import MotionManifold, learn_manifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import cut_windows
from numpy_cae.training import DivergedError, Schedule, Stage, train_autoencoder, zero_values
from numpy_cae.viz import PROJECTED, dots_figure

P = 0.5
"""The probability with which a value of a test window is removed."""
RECONSTRUCTION, HALF_REMOVED = "reconstruction, cm", "half of the values removed, cm"
"""The two measures of a method, both errors of test windows: undamaged, and after each value was
removed with probability `P`."""
MEASURES = RECONSTRUCTION, HALF_REMOVED
Measured = dict[str, float]
"""The measures of one method for one seed."""
DEEP = (
    "The deep architecture is effective (holden2015, section 7, leaves it to be justified): three "
    "layers repair better than {}, equal parameters."
)
CHOICE = "The paper's choice repairs better: {} against {}."
SENTENCES = {
    rows_of.ONE_LAYER: DEEP.format("one"),
    rows_of.TWO_LAYERS: DEEP.format("two"),
    rows_of.EVEN_UNPOOLING: CHOICE.format("unpooling at random while a layer is trained", "evenly"),
    rows_of.NOTHING_REMOVED: CHOICE.format("denoising with p = 0.1", "none"),
    rows_of.LAYERS_ALONE: CHOICE.format("fine tuning after the layers", "none"),
    rows_of.END_TO_END: CHOICE.format("training layer by layer first", "end to end alone"),
}
"""The claim that a row tests, by the row without the paper's choice."""
ADAM = "With Adam too, training layer by layer first repairs better than end to end alone."


class Evaluation:
    """Takes, cut into windows once; ValueError for none to train on or none to test."""

    def __init__(self, material: Material):
        takes = [take.positions for take in material.training]
        untrained = Schedule(Stage(epochs=0), Stage(epochs=0))
        # For the mean pose, the scale and the mean skeleton; its network is not used.
        self.frame = learn_manifold(takes, untrained, filters=(1,), taps=1)
        self.testing, self.sample = testing_of(self.frame, material)
        self.windows = np.concatenate(
            [self.frame.normalise(cut_windows(self.frame.features(take)[0])[0]) for take in takes]
        )

    def manifold(self, network: ConvAutoencoder, rescaled: bool) -> MotionManifold:
        """The network with the common mean pose and scale."""
        return replace(self.frame, network=network, rescales=rescaled)

    def measure(self, repair: Callable[[np.ndarray], np.ndarray], seed: int) -> Measured:
        """Both measures of a method that repairs normalised windows (N, T, 63).

        The seed chooses the values that are removed.
        """
        truth = self.testing
        damaged = zero_values(truth.x, P, np.random.default_rng(seed))
        return {
            RECONSTRUCTION: truth.error(repair(truth.x)),
            HALF_REMOVED: truth.error(repair(damaged)),
        }


@dataclass(frozen=True)
class Row:
    """One line of the table; `measured` has an entry for each seed, None where it diverged."""

    name: str
    parameters: int = 0
    measured: list[Measured | None] = field(default_factory=list)

    def values(self, measure: str) -> np.ndarray:
        """A measure by seed, (S,); nan where there is none."""
        return np.array([one[measure] if one else np.nan for one in self.measured])

    def cell(self, measure: str) -> str:
        """Mean ± standard deviation over the seeds that did not diverge."""
        values = self.values(measure)
        values, diverged = values[np.isfinite(values)], self.measured.count(None)
        if not len(values):
            return "diverged"
        spread = f" ± {values.std(ddof=1):.2f}" if len(values) > 1 else ""
        note = f" ({diverged} diverged)" if diverged else ""
        return f"{values.mean():.2f}{spread}{note}"


def measure_rows(
    evaluation: Evaluation,
    choices: Sequence[Choice],
    seeds: int = SEEDS,
    progress: Callable[[str], None] = lambda line: None,
) -> list[Row]:
    """Train and measure every choice, all of them from one seed after another.

    The paper's choice is the first. `progress` gets a line of text after each measurement.
    """
    rows = [Row(choice.name, choice.parameters) for choice in choices]
    for seed in range(seeds):
        for row, choice in zip(rows, choices, strict=True):
            last = _train_and_measure(evaluation, choice, seed)
            row.measured.append(last)
            status = f"half removed {last[HALF_REMOVED]:.2f} cm" if last else "diverged"
            progress(f"seed {seed}: {row.name}: {status}")
    return rows


def _train_and_measure(evaluation: Evaluation, choice: Choice, seed: int) -> Measured | None:
    """None where training diverges."""
    rng = np.random.default_rng(seed)
    network = choice.network(rng)
    try:
        train_autoencoder(network, evaluation.windows, choice.schedule, rng)
    except DivergedError:
        return None
    manifold = evaluation.manifold(network, choice.schedule.fine_tuning.rescaled)
    return evaluation.measure(manifold.project_windows, seed)


def ablation_result(rows: Sequence[Row], sample: str) -> Result:
    """Compare every row with the first, the paper's network; `sample` says what was measured on."""
    cells = [[row.name, row.parameters, *map(row.cell, MEASURES)] for row in rows]
    note = (
        f"Mean ± standard deviation of {len(rows[0].measured)} seeds. Every row differs from the "
        f"first in what it is named after. {sample}"
    )
    named = {row.name: row for row in rows}
    claims = [_claim(sentence, rows[0], named[name]) for name, sentence in SENTENCES.items()]
    claims.append(_claim(ADAM, named[rows_of.ADAM_LAYERS], named[rows_of.ADAM_END_TO_END]))
    return Result(
        "Ablation: depth, unpooling, denoising and training",
        [Table("", ["method", "parameters", *MEASURES], cells)],
        claims,
        lambda: dots_figure(
            [row.name for row in rows],
            [PROJECTED] * len(rows),
            {measure: [row.values(measure) for row in rows] for measure in MEASURES},
        ),
        note=note,
    )


def _claim(sentence: str, paper: Row, other: Row) -> Claim:
    """Whether the paper's choice repairs better in every seed; one that diverged does not."""
    figures = "; ".join(
        f"{measure} {paper.cell(measure)} against {other.cell(measure)}" for measure in MEASURES
    )
    with_choice, without = (row.values(HALF_REMOVED) for row in (paper, other))
    both = np.isfinite(with_choice).any() and np.isfinite(without).any()
    effect = (
        f"by {np.nanmean(without) / np.nanmean(with_choice) - 1:+.0%}"
        if both
        else "beyond all bounds"
    )
    better = np.nan_to_num(with_choice, nan=np.inf) < np.nan_to_num(without, nan=np.inf)
    return Claim(
        sentence,
        bool(better.all()),
        f"{figures}. The alternative changes the error of repair {effect}; the paper's choice is "
        f"better in {better.sum()} of {len(better)} seeds (confirmed if in all).",
    )
