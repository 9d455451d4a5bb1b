"""The ablation of holden2015: one choice of its network and training varied at a time.

"We also wish to thoroughly evaluate our work against alternative methods and justify the
effectiveness of using a deep architecture" (holden2015, section 7). Every row is trained and
measured from several seeds. A seed sets the first weights, the order, the corruption and the
removed values of the test, equally for all rows, so that rows are compared seed by seed. All
networks share the schedule of the first row, except for what a row is named after. The lab book has
the figures of further rows, most of which changed little.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from numpy_cae.experiments.clips import testing_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.fast import accelerate
from numpy_cae.manifold import learn_manifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import cut_windows
from numpy_cae.motion.features import FEATURES
from numpy_cae.training import DivergedError, Schedule, Stage, train_autoencoder, zero_values
from numpy_cae.training.schedule import EVEN
from numpy_cae.viz import PROJECTED
from numpy_cae.viz.curves import dots_figure

TAPS = 15
FILTERS = (32, 64, 128)
"""Filters of the three layers; the paper has 64, 128 and 256."""
OF_ONE_LAYER, OF_TWO_LAYERS = (195,), (64, 128)
"""Filters of networks that have as many parameters as FILTERS, as nearly as possible."""
LAYER_EPOCHS, FINE_EPOCHS = 4, 12
"""Epochs of each layer and of fine tuning."""
SEEDS = 5
ADAM_RATE = 0.004
"""Peak of the one-cycle schedule of the rows with Adam, the best of 0.001 to 0.008 on takes that
are not the test takes (lab book)."""
PAPER = "as holden2015, smaller"
ONE_LAYER, TWO_LAYERS = "one layer, equal parameters", "two layers, equal parameters"
EVEN_UNPOOLING = "even unpooling from the start"
NOTHING_REMOVED, WIDE_P = "no values removed", "p from 0.1 to 0.8, X_c / (1 - p)"
LAYERS_ALONE, END_TO_END = "layers alone, no fine tuning", "end to end, no layers before"
ADAM_LAYERS, ADAM_END_TO_END = "Adam, layer by layer", "Adam, end to end"
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
    ONE_LAYER: DEEP.format("one"),
    TWO_LAYERS: DEEP.format("two"),
    EVEN_UNPOOLING: CHOICE.format("unpooling at random while a layer is trained", "evenly"),
    NOTHING_REMOVED: CHOICE.format("denoising with p = 0.1", "none"),
    LAYERS_ALONE: CHOICE.format("fine tuning after the layers", "none"),
    END_TO_END: CHOICE.format("training layer by layer first", "end to end alone"),
}
"""The claim that a row tests, by the row without the paper's choice."""
ADAM = "With Adam too, training layer by layer first repairs better than end to end alone."


@dataclass(frozen=True)
class Row:
    """A network, its training and its errors: one line of the table.

    `measured` has an entry for each seed, None where training diverged.
    """

    name: str
    filters: tuple[int, ...]
    schedule: Schedule
    measured: list[Measured | None] = field(default_factory=list)

    @property
    def parameters(self) -> int:
        """Number of values in W and b of all layers."""
        sizes = pairwise((FEATURES, *self.filters))
        return sum(TAPS * below * above + above for below, above in sizes)

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


def all_rows(layer_epochs: int = LAYER_EPOCHS, fine_epochs: int = FINE_EPOCHS) -> list[Row]:
    """Every row of the table, the paper's first, not yet measured.

    Steps average over eight windows and have
    momentum, to train quickly; the rate falls to a tenth over each stage. α, corruption and
    unpooling are the paper's.
    """
    layer = Stage(epochs=layer_epochs, rate=0.5, decay=_decay(layer_epochs), batch=8, momentum=0.9)
    fine = replace(layer, epochs=fine_epochs, rate=0.3, decay=_decay(fine_epochs), alpha=0.0)

    def varied(
        name: str,
        of_layer: dict | None = None,
        of_fine: dict | None = None,
        filters: tuple[int, ...] = FILTERS,
    ) -> Row:
        schedule = Schedule(replace(layer, **of_layer or {}), replace(fine, **of_fine or {}))
        return Row(name, filters, schedule)

    nothing, wide = {"zeroed": 0.0}, {"zeroed": (0.1, 0.8), "rescaled": True}
    all_epochs = layer_epochs + fine_epochs
    no_layers, end_to_end = {"epochs": 0}, {"epochs": all_epochs, "decay": _decay(all_epochs)}
    adam = {"optimiser": "adam", "rate_schedule": "one-cycle", "rate": ADAM_RATE, "norm": 0.05}
    return [
        varied(f"{PAPER}: {'-'.join(map(str, FILTERS))} filters"),
        varied(ONE_LAYER, filters=OF_ONE_LAYER),
        varied(TWO_LAYERS, filters=OF_TWO_LAYERS),
        varied(EVEN_UNPOOLING, {"unpooling": EVEN}),
        varied(NOTHING_REMOVED, nothing, nothing),
        varied(WIDE_P, wide, wide),
        varied(LAYERS_ALONE, of_fine={"epochs": 0}),
        varied(END_TO_END, no_layers, end_to_end),
        varied(ADAM_LAYERS, adam, adam),
        varied(ADAM_END_TO_END, no_layers, adam | end_to_end),
    ]


def _decay(epochs: int) -> float:
    return 0.1 ** (1 / max(epochs, 1))


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


def measure_rows(
    evaluation: Evaluation,
    rows: Sequence[Row],
    seeds: int = SEEDS,
    progress: Callable[[str], None] = lambda line: None,
) -> None:
    """Train and measure every row, all of them from one seed after another.

    `progress` gets a line of text after each measurement.
    """
    for seed in range(seeds):
        for row in rows:
            last = _train_and_measure(evaluation, row, seed)
            row.measured.append(last)
            status = f"half removed {last[HALF_REMOVED]:.2f} cm" if last else "diverged"
            progress(f"seed {seed}: {row.name}: {status}")


def _train_and_measure(evaluation: Evaluation, row: Row, seed: int) -> Measured | None:
    """None where training diverges."""
    rng = np.random.default_rng(seed)
    network = accelerate(ConvAutoencoder(filters=row.filters, taps=TAPS, rng=rng))
    try:
        train_autoencoder(network, evaluation.windows, row.schedule, rng)
    except DivergedError:
        return None
    rescaled = row.schedule.fine_tuning.rescaled
    manifold = replace(evaluation.frame, network=network, rescales=rescaled)
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
    claims.append(_claim(ADAM, named[ADAM_LAYERS], named[ADAM_END_TO_END]))
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
