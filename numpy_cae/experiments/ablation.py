"""The ablation of holden2015: one choice of its network and training varied at a time.

"We also wish to thoroughly evaluate our work against alternative methods and justify the
effectiveness of using a deep architecture" (holden2015, section 7). Every row is trained and
measured from several seeds. A seed sets the first weights, the order, the corruption and the
removed values of the test, equally for all rows, so that rows are compared seed by seed. All
networks share the schedule of the first row, except for what a row is named after. The lab book has
the figures of further rows, most of which changed little.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise

import numpy as np

from numpy_cae.experiments.clips import testing_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.fast import accelerate
from numpy_cae.manifold import MotionManifold, learn_manifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import cut_windows
from numpy_cae.motion.features import FEATURES
from numpy_cae.training import DivergedError, Schedule, Stage, train_autoencoder, zero_values
from numpy_cae.training.schedule import EVEN
from numpy_cae.viz import bars_figure

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
PAPER, ADAM_LAYERS = "as holden2015, smaller: 32-64-128 filters", "Adam, layer by layer"
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
ADAM = "With Adam too, training layer by layer first repairs better than end to end alone."


@dataclass(frozen=True)
class Row:
    """A network, its training and its errors: one line of the table.

    `measured` has an entry for each seed, nan where training diverged. `claim` says that the row
    named `better` repairs better than this one.
    """

    name: str
    filters: tuple[int, ...]
    schedule: Schedule
    claim: str = ""
    better: str = PAPER
    measured: list[Measured] = field(default_factory=list)

    @property
    def parameters(self) -> int:
        """Number of values in W and b of all layers."""
        sizes = pairwise((FEATURES, *self.filters))
        return sum(TAPS * below * above + above for below, above in sizes)

    def values(self, measure: str) -> np.ndarray:
        """A measure by seed, (S,); nan where training diverged."""
        return np.array([one[measure] for one in self.measured])

    def mean(self, measure: str) -> float:
        """The mean over the seeds that did not diverge; nan if all did."""
        values = self.values(measure)
        return np.nan if np.isnan(values).all() else float(np.nanmean(values))

    def cell(self, measure: str) -> str:
        """Mean ± standard deviation over the seeds that did not diverge."""
        values = self.values(measure)
        diverged = np.count_nonzero(np.isnan(values))
        if diverged == len(values):
            return "diverged"
        spread = f" ± {np.nanstd(values, ddof=1):.2f}" if len(values) - diverged > 1 else ""
        note = f" ({diverged} diverged)" if diverged else ""
        return f"{self.mean(measure):.2f}{spread}{note}"


def all_rows(layer_epochs: int = LAYER_EPOCHS, fine_epochs: int = FINE_EPOCHS) -> list[Row]:
    """Every row of the table, the paper's first, not yet measured.

    Steps average over eight windows and have
    momentum, to train quickly; the rate falls to a tenth over each stage. α, corruption and
    unpooling are the paper's.
    """
    layer = Stage(epochs=layer_epochs, rate=0.5, batch=8, momentum=0.9)
    fine = replace(layer, epochs=fine_epochs, rate=0.3, alpha=0.0)
    nothing, wide = {"zeroed": 0.0}, {"zeroed": (0.1, 0.8), "rescaled": True}
    none, end_to_end = {"epochs": 0}, {"epochs": layer_epochs + fine_epochs}
    adam = {"optimiser": "adam", "rate_schedule": "one-cycle", "rate": ADAM_RATE, "norm": 0.05}
    unpooling = CHOICE.format("unpooling at random while a layer is trained", "evenly")
    corrupted = CHOICE.format("denoising with p = 0.1", "none")
    tuned = CHOICE.format("fine tuning after the layers", "none")
    stacked = CHOICE.format("training layer by layer first", "end to end alone")
    # Name, filters, what differs in the layers' stages and in fine tuning, and the claim.
    rows: list[tuple] = [
        (PAPER, FILTERS, {}, {}),
        ("one layer, equal parameters", (195,), {}, {}, DEEP.format("one")),
        ("two layers, equal parameters", (64, 128), {}, {}, DEEP.format("two")),
        ("even unpooling from the start", FILTERS, {"unpooling": EVEN}, {}, unpooling),
        ("no values removed", FILTERS, nothing, nothing, corrupted),
        ("p from 0.1 to 0.8, X_c / (1 - p)", FILTERS, wide, wide),
        ("layers alone, no fine tuning", FILTERS, {}, none, tuned),
        ("end to end, no layers before", FILTERS, none, end_to_end, stacked),
        (ADAM_LAYERS, FILTERS, adam, adam),
        ("Adam, end to end", FILTERS, none, adam | end_to_end, ADAM, ADAM_LAYERS),
    ]
    return [
        Row(name, filters, Schedule(_falling(layer, of_layer), _falling(fine, of_fine)), *claim)
        for name, filters, of_layer, of_fine, *claim in rows
    ]


def _falling(stage: Stage, changes: dict) -> Stage:
    """The changed stage, with a rate that falls to a tenth."""
    changed = replace(stage, **changes)
    return replace(changed, decay=0.1 ** (1 / max(changed.epochs, 1)))


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Train and compare the networks of all rows; `manifold` is not used."""
    evaluation, rows = Evaluation(material), all_rows()
    to_stderr = partial(print, file=sys.stderr, flush=True)
    measure_rows(evaluation, rows, range(seed, seed + SEEDS), to_stderr)
    return ablation_result(rows, evaluation.sample)


class Evaluation:
    """Takes, cut once into windows that are scaled to `rms`, as in `Schedule`; ValueError for none
    to train on or none to test."""

    def __init__(self, material: Material, rms: float = Schedule().rms):
        takes = [take.positions for take in material.training]
        untrained = Schedule(Stage(epochs=0), Stage(epochs=0), rms=rms)
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
    seeds: Sequence[int],
    progress: Callable[[str], None] = lambda line: None,
) -> None:
    """Train and measure every row, all of them from one seed after another.

    `progress` gets a line of text after each measurement.
    """
    for seed in seeds:
        for row in rows:
            row.measured.append(_train_and_measure(evaluation, row, seed))
            progress(f"seed {seed}: {row.name}: {row.measured[-1][HALF_REMOVED]:.2f} cm")


def _train_and_measure(evaluation: Evaluation, row: Row, seed: int) -> Measured:
    rng = np.random.default_rng(seed)
    network = accelerate(ConvAutoencoder(filters=row.filters, taps=TAPS, rng=rng))
    try:
        train_autoencoder(network, evaluation.windows, row.schedule, rng)
    except DivergedError:
        return dict.fromkeys(MEASURES, np.nan)
    rescaled = row.schedule.fine_tuning.rescaled
    manifold = replace(evaluation.frame, network=network, rescales=rescaled)
    return evaluation.measure(manifold.project_windows, seed)


def ablation_result(rows: Sequence[Row], sample: str) -> Result:
    """Compare every row with the first, the paper's network; `sample` says what was measured on."""
    cells = [[row.name, row.parameters, *map(row.cell, MEASURES)] for row in rows]
    note = (
        "The networks are smaller than the paper's and trained for less. "
        f"Mean ± standard deviation of {len(rows[0].measured)} seeds. Every row differs from the "
        f"first in what it is named after. {sample}"
    )
    named = {row.name: row for row in rows}
    return Result(
        "Ablation: depth, unpooling, denoising and training",
        [Table("", ["method", "parameters", *MEASURES], cells)],
        [_claim(row.claim, named[row.better], row) for row in rows if row.claim],
        lambda: bars_figure(
            [row.name for row in rows],
            [(measure, [row.mean(measure) for row in rows], None) for measure in MEASURES],
            "error, cm",
        ),
        note=note,
    )


def _claim(sentence: str, paper: Row, other: Row) -> Claim:
    """Whether the paper's choice repairs better in every seed; one that diverged does not."""
    errors, others = (np.nan_to_num(row.values(HALF_REMOVED), nan=np.inf) for row in (paper, other))
    better = errors < others
    figures = "; ".join(
        f"{measure} {paper.cell(measure)} against {other.cell(measure)}" for measure in MEASURES
    )
    return Claim(
        sentence,
        bool(better.all()),
        f"{figures}. The paper's choice is better in {better.sum()} of {len(better)} seeds "
        "(confirmed if in all).",
    )
