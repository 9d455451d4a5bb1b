"""The paper at its size: its schedule to the letter on 9,673 windows, beside simple methods.

    python -m studies paper_size --windows 466 2000 9673 --models trained

holden2015, section 4, cuts 9,673 windows from 2,605 recordings of the CMU database. The database is
not here: the takes are as many synthetic ones (`python -m data_synth motions --cmu-scale`), and the
test takes are of other people. Half of the values of the test windows are removed. The methods
above "mask:" are given the zeros as they are, the others use that a value that is zero is missing.
A model that is in the folder `models` is not trained again.
"""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from data_synth import Plan, plan_cmu_scale, plan_takes
from numpy_cae.cli.shared.output import note
from numpy_cae.evaluation.half_removed import half_removed
from numpy_cae.manifold import MotionManifold, learn_manifold, load_manifold
from numpy_cae.mocap import body_of
from numpy_cae.motion import RATE
from numpy_cae.motion.windows import LENGTH
from numpy_cae.training import Schedule, TrainingState
from studies.shared.result import Claim, Result, Table

TEST_MINUTES = 15.0
PAPER_MINUTES = {"layer 1": 43, "layer 2": 51, "layer 3": 77, "fine tuning": 133}
"""Of the paper's training on a Quadro K2000 (section 7)."""
NETWORK = "the network"
Takes = list[np.ndarray]


def run(
    windows: tuple[int, ...] = (466, 2000, 9673),
    seed: int = 0,
    models: Path | None = None,
    progress: Callable[[TrainingState], None] | None = None,
) -> Result:
    """Train by the paper's schedule on so many windows, and repair the test takes.

    The people of the test takes are those of the next seed.
    """
    testing = _made(plan_takes(TEST_MINUTES, seed + 1))
    errors: dict[str, list[float]] = {}
    times: dict[str, list[float]] = {name: [] for name in PAPER_MINUTES}
    counts = []
    for count in windows:
        training = _made(_first(plan_cmu_scale(seed), count))
        manifold = _trained(training, count, seed, models, progress)
        counts.append(manifold.settings["windows"])
        for row in half_removed(manifold, training, testing, seed).rows:
            errors.setdefault(str(row[0]), []).append(float(row[2]))
        for stage, seconds in manifold.settings["seconds"].items():
            times[stage].append(seconds)
    columns = [f"{count:,} windows" for count in counts]
    rows = [[name, *row] for name, row in errors.items()]
    stages = [
        [name, *row, row[-1] / (60 * PAPER_MINUTES[name]), PAPER_MINUTES[name]]
        for name, row in times.items()
    ]
    header = ["stage", *(f"s, {column}" for column in columns), "of the paper's", "paper, minutes"]
    formats = ("", *[".0f"] * len(columns), ".3f", "")
    network = errors[NETWORK]
    pairs = f"{network[0]:.2f} cm with {columns[0]}, {network[-1]:.2f} cm with {columns[-1]}."
    return Result(
        "The paper at its size",
        [
            Table("Half of the values removed, error in cm:", ["method", *columns], rows),
            Table("Seconds of each stage:", header, stages, formats),
        ],
        [Claim("scales_with_data", network[-1] < network[0], pairs)],
    )


def _first(plans: Sequence[Plan], count: int) -> list[Plan]:
    """The first plans that have together at least so many windows."""
    frames = np.array([round(plan.seconds * RATE) for plan in plans])
    made = np.cumsum(np.maximum(1, -(-(frames - LENGTH) // (LENGTH // 2)) + 1))
    return list(plans[: np.searchsorted(made, count) + 1])


def _made(plans: Sequence[Plan]) -> Takes:
    note(f"{len(plans)} takes are made")
    return [body_of(plan.make(RATE).motion) for plan in plans]


def _trained(
    takes: Takes, count: int, seed: int, models: Path | None, progress: Callable | None
) -> MotionManifold:
    """The manifold of that many windows; its settings have the seconds of each stage."""
    path = models and models / f"paper_{count}.npz"
    if path and path.exists():
        return load_manifold(path)
    seconds: dict[str, float] = {}
    note(f"{count} windows")

    def report(state: TrainingState) -> None:
        seconds[state.name] = state.history.seconds[state.name]
        if progress:
            progress(state)

    manifold = learn_manifold(takes, Schedule(), seed, report=report)
    manifold.settings["seconds"] = seconds
    if path:
        path.parent.mkdir(parents=True, exist_ok=True)
        manifold.save(path)
    return manifold
