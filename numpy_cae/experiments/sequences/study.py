"""Train jang2018's network on one action and measure it on held-out motions during training.

error         mean over frames of ‖θ̂ - θ‖, radians: "Euclidean distance … in the joint angle
              space"
discrepancy   the sliced Wasserstein distance between the latent vectors of held-out clips and
              fresh draws of the prior
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from data_synth import plan_takes
from numpy_cae import ops
from numpy_cae.evaluation import angle_distance
from numpy_cae.experiments.material import each_usable
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.manifold import SequenceManifold
from numpy_cae.manifold.learning import train_on_sequences, untrained_sequences
from numpy_cae.mocap import Coordinates, angles_of, body_positions
from numpy_cae.mocap.load import is_test, load_angles
from numpy_cae.mocap.rigs.rigs import Mappings
from numpy_cae.motion import cut_clips, draw_clips
from numpy_cae.motion.angles import ANGLE_RATE, AngleSequence
from numpy_cae.training import SequenceSchedule, TrainingState, unit_directions

if TYPE_CHECKING:
    from matplotlib.figure import Figure


PERIODIC = ("walking", "walking_extra")
"""Actions of which jang2018 says that all samples look alike."""
CLIPS, DIRECTIONS = 1000, 128
"""Latent vectors, and directions, of one measurement of the discrepancy."""
CURVE_POINTS = 40
Curve = dict[str, np.ndarray]
""""error" and "discrepancy" against the number of "steps", (P,) arrays."""
MEASURES = {"error": "reconstruction error, rad", "discrepancy": "discrepancy to the prior"}


@dataclass(frozen=True)
class Action:
    """Motions of one action, split by take, and whether it repeats itself, as walking does."""

    name: str
    training: list[AngleSequence]
    testing: list[AngleSequence]
    periodic: bool = False


def synthetic_action(
    kind: str, minutes: float, seed: int = 0, report: Callable[[int, int], None] | None = None
) -> Action:
    """Synthesise an action of `data_synth.JANG2018_KINDS`, so many minutes to train on and to test
    on; every take is of another person.

    With few people, the discrepancy of the held-out clips would measure who these people are
    rather than how the network encodes them. `report` is called before each take with the number
    of takes that are made and that of all.
    """
    plans = [plan_takes(minutes, number, [kind]) for number in (2 * seed + 1, 2 * seed + 2)]
    halves: tuple[list[AngleSequence], list[AngleSequence]] = ([], [])
    for made, plan in enumerate([*plans[0], *plans[1]]):
        if report is not None:
            report(made, len(plans[0]) + len(plans[1]))
        take = replace(plan, person=plan.number).make(ANGLE_RATE)
        halves[made >= len(plans[0])].append(angles_of(take.motion))
    return Action(kind, *halves, periodic=kind in PERIODIC)


def read_action(
    name: str,
    folders: Sequence[str | Path],
    patterns: Sequence[str],
    mapping: Mappings = None,
    coordinates: Coordinates | None = None,
) -> Action:
    """Read every motion file below the folders; those whose name matches a pattern are for testing.

    `mapping` and `coordinates` are those of `load_angles`.
    """
    halves: tuple[list[AngleSequence], list[AngleSequence]] = ([], [])
    angles = each_usable(folders, lambda path: load_angles(path, mapping, coordinates))
    for path, sequence in angles:
        halves[is_test(path, patterns)].append(sequence)
    return Action(name, *halves, periodic=name in PERIODIC)


@dataclass(frozen=True)
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
        clips = draw_clips(sequences, count, np.random.default_rng(seed), self.manifold.frames)
        return self.manifold.normalise(clips)

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
    **network,
) -> Study:
    """Train on one action and record the curve of held-out errors, only its start if λ = 0.

    `network` are the arguments of `untrained_sequences` that describe the network.
    """
    rng, rng_of_errors = np.random.default_rng(seed), np.random.default_rng([seed, 1])
    manifold = untrained_sequences(action.training, rng, **network)
    interval = max(1, schedule.epochs * schedule.steps // CURVE_POINTS)
    curve: dict[str, list] = {"steps": [], "error": [], "discrepancy": []}

    def measure(step: int) -> None:
        # Both errors use the same fresh clips: all test clips would take a third of the training.
        clips = draw_clips(action.testing, CLIPS, rng_of_errors, manifold.frames)
        x = manifold.normalise(clips)
        z = manifold.network.encode(x)
        x_hat = manifold.network.decode(z, x.shape[1])
        error = angle_distance(manifold.denormalise(x_hat), manifold.denormalise(x))
        values = step, error, discrepancy(z, rng_of_errors)
        for column, value in zip(curve.values(), values, strict=True):
            column.append(value)

    def report_and_measure(state: TrainingState) -> None:
        if report is not None:
            report(state)
        step = state.epoch * state.steps + state.step
        # Figure 2 needs no curve of a training without the regulariser.
        if schedule.weight and step % interval == 0:
            measure(step)

    measure(0)
    train_on_sequences(manifold, action.training, schedule, rng, report_and_measure)
    manifold.settings = {"seed": seed} | manifold.settings
    return Study(action, manifold, {name: np.array(values) for name, values in curve.items()})


def discrepancy(z: np.ndarray, rng: np.random.Generator) -> float:
    """The sliced Wasserstein distance of z (N, D) to N fresh draws of the prior."""
    z = z.astype(np.float64)
    prior = rng.standard_normal(z.shape)
    directions = unit_directions(DIRECTIONS, z.shape[1], rng, np.float64)
    return float(ops.sliced_wasserstein(z, prior, directions)[0])


def figure_2(studies: Sequence[Study]) -> Result:
    """Compare the first and the last tenth of each curve."""
    curves = {study.action.name: study.curve for study in studies}
    rows = []
    for action, curve in curves.items():
        for measure, name in MEASURES.items():
            tenth = max(1, len(curve[measure]) // 10)
            first, last = curve[measure][:tenth].mean(), curve[measure][-tenth:].mean()
            rows.append([f"{action}: {name}", first, last, last / first])
    formats = ("", ".3f", ".3f", ".2f")
    table = Table("", ["curve", "first tenth", "last tenth", "ratio"], rows, formats)
    claims = [_claim(table, name, list(curves)) for name in MEASURES.values()]
    title = "Figure 2 of jang2018: errors against iterations"
    return Result(title, [table], claims, lambda: _draw(curves))


def _claim(table: Table, name: str, actions: Sequence[str]) -> Claim:
    ratios = {action: table.value(f"{action}: {name}", "ratio") for action in actions}
    remaining = ", ".join(f"{action} {ratio:.2f}" for action, ratio in ratios.items())
    return Claim(
        f"As the iteration increases, the {name.split(',')[0]} gradually decreases (jang2018, "
        "Results; here: the last tenth is below half of the first).",
        all(ratio < 0.5 for ratio in ratios.values()),
        f"Ratio of the last tenth to the first: {remaining}.",
    )


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
