"""Train jang2018's network on one action and measure it on held-out motions during training.

error         mean over frames of ‖θ̂ - θ‖, radians: "Euclidean distance … in the joint angle
              space"
discrepancy   the sliced Wasserstein distance between the latent vectors of held-out clips and
              fresh draws of the prior
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae import ops
from numpy_cae.evaluation import angle_distance
from numpy_cae.evaluation.tables import Table
from numpy_cae.manifold import SequenceManifold, learn_sequences
from numpy_cae.mocap import body_positions
from numpy_cae.motion import cut_clips
from numpy_cae.training import SequenceSchedule, TrainingState, train_sequential, unit_directions
from studies.jang2018.actions import Action
from studies.jang2018.mmd import MmdEngine
from studies.shared.result import Claim, Picture, Result
from studies.shared.trained import Trainer

CLIPS = 1000
"""Latent vectors of one measurement of the discrepancy."""
DIRECTIONS = 128
"""Directions of one measurement of the discrepancy."""
CURVE_POINTS = 40
Curve = dict[str, np.ndarray]
""""error" and "discrepancy" against the number of "steps", (P,) arrays."""


@dataclass(frozen=True, eq=False)
class Study:
    """A trained manifold, the action it was trained on and the curve of its training."""

    action: Action
    manifold: SequenceManifold
    curve: Curve | None = None

    def held_out(self) -> np.ndarray:
        """All normalised clips of the test motions, (N, F, 54)."""
        return self.manifold.normalise(cut_clips(self.action.testing, frames=self.manifold.frames))

    def random_clips(self, count: int, seed: int, training: bool = True) -> np.ndarray:
        """Normalised clips with random first frames, (count, F, 54)."""
        sequences = self.action.training if training else self.action.testing
        return self.manifold.random_clips(sequences, np.random.default_rng(seed), count)

    def squared_error(self) -> float:
        """Mean squared error of held-out clips after encoding and decoding, standardised."""
        x = self.held_out()
        return float(np.mean((self.manifold.network.denoise(x) - x) ** 2, dtype=np.float64))

    def positions(self, clip: np.ndarray) -> np.ndarray:
        """Joint positions (F, 20, 3) in metres of a normalised clip (F, 54)."""
        return body_positions(self.manifold.motion(clip))


def train_study(
    action: Action,
    schedule: SequenceSchedule,
    seed: int = 0,
    report: Callable[[TrainingState], None] | None = None,
    mmd: bool = False,
    points: int = CURVE_POINTS,
    **network,
) -> Study:
    """Train on one action and record the curve of held-out errors, of about so many points; none if
    λ = 0 or with `mmd`.

    With `mmd` the regulariser is the maximum mean discrepancy of the codes from the prior.
    `network` are the arguments of `learn_sequences` that describe the network.
    """
    rng = np.random.default_rng(seed)
    rng_of_errors = np.random.default_rng([seed, 1])
    manifold = learn_sequences(action.training, replace(schedule, epochs=0), rng, **network)
    manifold.settings = {"action": action.described(), "seed": seed, "schedule": str(schedule)}
    measured = manifold.network
    interval = max(1, schedule.epochs * schedule.steps // points)
    # Figure 2 needs no curve of a training with another regulariser or none.
    has_curve = schedule.weight and not mmd
    curve: dict[str, list] = {"steps": [], "error": [], "discrepancy": []}

    def measure(step: int) -> None:
        # Both errors use the same fresh clips: all test clips would take a third of the training.
        x = manifold.random_clips(action.testing, rng_of_errors, CLIPS)
        z = measured.encode(x)
        x_hat = measured.decode(z, x.shape[1])
        error = angle_distance(manifold.denormalise(x_hat), manifold.denormalise(x))
        values = step, error, discrepancy(z, rng_of_errors)
        for column, value in zip(curve.values(), values, strict=True):
            column.append(value)

    def report_and_measure(state: TrainingState) -> None:
        if report is not None:
            report(state)
        step = state.epoch * state.steps + state.step
        if has_curve and step % interval == 0:
            measure(step)

    if has_curve:
        measure(0)
    trained = MmdEngine(measured, None) if mmd else measured
    draw = partial(manifold.random_clips, action.training)
    train_sequential(trained, draw, schedule, rng, report_and_measure)
    return Study(action, manifold, {name: np.array(values) for name, values in curve.items()})


def learn_study(
    trainer: Trainer,
    action: Action,
    schedule: SequenceSchedule,
    seed: int = 0,
    mmd: bool = False,
    points: int = CURVE_POINTS,
    **network: int,
) -> Study:
    """`train_study`, or what the trainer keeps of the same takes and arguments."""

    def train() -> SequenceManifold:
        study = train_study(action, schedule, seed, trainer.report, mmd, points, **network)
        study.manifold.settings["curve"] = {
            name: values.tolist() for name, values in study.curve.items()
        }
        return study.manifold

    takes = [sequence.numbers for sequence in (*action.training, *action.testing)]
    counts = (len(action.training), len(action.testing))
    manifold = trainer.keep(train, *takes, counts, schedule, seed, mmd, points, network)
    curve = manifold.settings["curve"]
    return Study(action, manifold, {name: np.array(values) for name, values in curve.items()})


def discrepancy(z: np.ndarray, rng: np.random.Generator) -> float:
    """The sliced Wasserstein distance of z (N, D) to N fresh draws of the prior."""
    z = z.astype(np.float64)
    prior = rng.standard_normal(z.shape)
    directions = unit_directions(DIRECTIONS, z.shape[1], rng, np.float64)
    return float(ops.sliced_wasserstein(z, prior, directions)[0])


if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEAST_PROBABILITY = 0.01
"""A curve has a trend if p is smaller than this."""
MEASURES = {"error": "reconstruction error, rad", "discrepancy": "discrepancy to the prior"}


def figure_2(studies: Sequence[Study]) -> Result:
    """Test the trend of each curve, and compare its first and its last tenth.

    τ is Kendall's correlation of the error with the iteration (the test of Mann and Kendall), p the
    probability that a curve without a trend has a τ so far from 0.
    """
    from scipy.stats import kendalltau  # slow to import

    curves = {study.action.name: study.curve for study in studies}
    rows = []
    for action, curve in curves.items():
        for measure, name in MEASURES.items():
            tenth = max(1, len(curve[measure]) // 10)
            first = curve[measure][:tenth].mean()
            last = curve[measure][-tenth:].mean()
            trend = kendalltau(curve["steps"], curve[measure])
            row = [f"{action}: {name}", first, last, last / first]
            rows.append([*row, float(trend.statistic), float(trend.pvalue)])
    formats = ("", ".3f", ".3f", ".2f", ".2f", ".1e")
    caption = "Errors on held-out clips against iterations (figure 2):"
    table = Table(caption, ["curve", "first tenth", "last tenth", "ratio", "τ", "p"], rows, formats)
    claims = [_claim(table, measure, list(curves)) for measure in MEASURES]
    title = "Figure 2 of jang2018: errors against iterations"
    return Result(title, [table], claims, {"figure_2": Picture(lambda: _draw(curves))})


def _claim(table: Table, measure: str, actions: Sequence[str]) -> Claim:
    names = [f"{action}: {MEASURES[measure]}" for action in actions]
    falls = True
    figures = []
    for name, action in zip(names, actions, strict=True):
        trend, probability, ratio = (table.value(name, column) for column in ("τ", "p", "ratio"))
        falls = falls and trend < 0 and probability < LEAST_PROBABILITY
        figures.append(f"{action} τ = {trend:.2f}, last tenth by first {ratio:.2f}")
    return Claim(f"{measure}_decreases", falls, f"{'; '.join(figures)}.")


def _draw(curves: dict[str, Curve]) -> Figure:
    """Two panels with a line for each action."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 3.4), layout="constrained")
    for axes, (measure, name) in zip(figure.subplots(1, 2), MEASURES.items(), strict=True):
        for action, curve in curves.items():
            axes.plot(curve["steps"], curve[measure], label=action.replace("_", " "))
        axes.set(xlabel="iterations", title=name)
        axes.set_yscale("log")
        axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    return figure
