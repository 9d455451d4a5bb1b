"""Computational time, holden2015, section 7: training stage by stage, and projection of a clip.

A model that `numpy-cae train` wrote knows how long each stage took. The paper had 9673 windows and
25 epochs a layer; ours are scaled to as many, which is what they are proportional to. Projection
is timed while you wait, on the machine that you wait for.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from numpy_cae.bench.paper import EPOCHS, MINUTES, WINDOWS
from numpy_cae.bench.timing import Timing, time_in_turns
from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.table import text_table
from numpy_cae.fast import accelerate
from numpy_cae.manifold import MotionManifold
from numpy_cae.training import Schedule, Stage, train_autoencoder
from numpy_cae.viz import PLAIN, PROJECTED, save_figure

REHEARSED = 32
"""Windows of a rehearsal, for a model that does not know how long its training took."""
ROUNDS = 15
_ENCODE, _PROJECT, _WHOLE = "Φ(X), a window", "Φ†(Φ(X)), a window", "Φ†(Φ(X)), a whole take"


@dataclass(frozen=True)
class Times:
    """What training took and what projection takes.

    Parameters
    ----------
    seconds, epochs, batch : stage to number
        Of the training, or of its rehearsal; `batch` windows in a step.
    windows : int
    rehearsed : bool
        Whether the training was only rehearsed, for an epoch.
    projection : name to Timing
        Of one call.
    window, take : int
        Frames of the window and of the take that were projected.
    """

    seconds: dict[str, float]
    epochs: dict[str, int]
    batch: dict[str, int]
    windows: int
    rehearsed: bool
    projection: dict[str, Timing]
    window: int
    take: int
    title: str = "Computational time"

    def scaled(self, stage: str) -> float:
        """Minutes that the stage would take with the paper's windows and epochs."""
        shown = self.windows * self.epochs[stage]
        return self.seconds[stage] / 60 * WINDOWS * EPOCHS / shown

    @property
    def total(self) -> float:
        """Of all stages, minutes."""
        return sum(map(self.scaled, self.seconds))

    def text(self) -> str:
        """Training beside the paper's, then projection."""
        stages = [
            [stage, str(self.epochs[stage]), str(self.batch[stage]), f"{seconds / 60:.3g}",
             f"{self.scaled(stage):.1f}", str(MINUTES.get(stage, ""))]
            for stage, seconds in self.seconds.items()
        ]  # fmt: skip
        stages.append(
            ["all", "", "", f"{sum(self.seconds.values()) / 60:.3g}", f"{self.total:.1f}",
             str(sum(MINUTES.values()))]
        )  # fmt: skip
        header = [
            "stage",
            "epochs",
            "batch",
            "minutes",
            f"of {WINDOWS} windows × {EPOCHS} epochs",
            "paper",
        ]
        timed = [
            [name, f"{1e3 * each.median:.2f}", f"±{each.spread:.0%}"]
            for name, each in self.projection.items()
        ]
        what = "One epoch rehearsed now" if self.rehearsed else "Training, as the model recorded it"
        return (
            f"{what}, on {self.windows} windows:\n\n"
            f"{text_table(header, stages)}\n\n"
            f"Projection, timed now; a window has {self.window} frames, the take {self.take}:\n\n"
            f"{text_table(['what', 'milliseconds', 'half the quartiles'], timed)}"
        )

    def findings(self) -> list[Finding]:
        """The paper's two figures."""
        encode, project = (1e3 * self.projection[name].median for name in (_ENCODE, _PROJECT))
        hours = sum(MINUTES.values()) / 60
        return [
            Finding(
                "Training the full network takes 5 hours and 4 minutes (holden2015, section 7, on "
                "a Quadro K2000): here it takes no longer.",
                self.total <= sum(MINUTES.values()),
                f"{self.total / 60:.1f} hours, scaled from {self.windows} windows to {WINDOWS} and "
                f"to {EPOCHS} epochs a stage, against {hours:.1f}.",
            ),
            Finding(
                "Projection can be done in a fraction of a millisecond (holden2015, section 7).",
                bool(encode < 1),
                f"Φ of a window takes {encode:.2f} ms, Φ and Φ† together {project:.2f} ms.",
            ),
        ]

    def save_picture(self, path: str | Path) -> None:
        """Bars: minutes of each stage beside the paper's, milliseconds of projection, PNG."""
        figure = Figure(figsize=(10, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        stages = list(self.seconds)
        place = np.arange(len(stages))
        here = [self.scaled(stage) for stage in stages]
        paper = [MINUTES.get(stage, 0) for stage in stages]
        for shift, minutes, name, colour in (
            (-0.2, here, "here, scaled", PROJECTED), (0.2, paper, "the paper", PLAIN)
        ):  # fmt: skip
            bars = left.bar(place + shift, minutes, 0.4, label=name, color=colour)
            left.bar_label(bars, fmt="%.0f", fontsize=8)
        left.set_xticks(place, stages)
        left.set_title(f"minutes of training: {WINDOWS} windows, {EPOCHS} epochs", fontsize=9)
        left.legend(frameon=False, fontsize=8)
        names = list(self.projection)
        took = [1e3 * each.median for each in self.projection.values()]
        right.bar_label(right.barh(names, took, color=PROJECTED), fmt="%.2f", fontsize=8, padding=2)
        right.axvline(1, color=PLAIN, linestyle=":")
        right.invert_yaxis()
        right.margins(x=0.15)
        right.set_title("milliseconds of projection (dotted: one)", fontsize=9)
        for axes in (left, right):
            axes.spines[["top", "right"]].set_visible(False)
            axes.tick_params(labelsize=8)
        save_figure(figure, path)


def times(manifold: MotionManifold, material: Material, seed: int = 0) -> Times:
    """Read how long training took, and time projection.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        A testing take is projected; training takes are used where training must be rehearsed.
    seed : int
        Of the rehearsal.

    Raises
    ------
    ValueError
        If no take is held out.
    """
    if not material.testing:
        raise ValueError("times needs a held-out take to project, there is none")
    settings = manifold.settings
    stages = {stage: _stage(settings["schedule"], stage) for stage in settings["losses"]}
    epochs = {stage: each["epochs"] for stage, each in stages.items()}
    batch = {stage: each["batch"] for stage, each in stages.items()}
    seconds, windows = settings.get("seconds"), settings["windows"]
    rehearsed = seconds is None or not all(epochs.values())
    if rehearsed:
        seconds, windows = _rehearse(manifold, material, batch, seed)
        epochs = dict.fromkeys(seconds, 1)
    lengths = [len(take.positions) for take in material.testing]
    middle = material.testing[int(np.argsort(lengths)[len(lengths) // 2])].positions
    window = clips_of(manifold, [middle]).x[:1]
    features = manifold.features(middle)[0]
    network = accelerate(manifold.network)
    projection = time_in_turns(
        {
            _ENCODE: lambda: network.encode(window),
            _PROJECT: lambda: network.project(window),
            _WHOLE: lambda: manifold.project(features),
        },
        ROUNDS,
    )
    return Times(
        seconds, epochs, batch, windows, rehearsed, projection, window.shape[1], len(middle)
    )


def _stage(schedule: dict, stage: str) -> dict:
    """What the schedule says of a stage; models of an earlier version had one batch for all."""
    said = schedule["fine_tuning" if stage == "fine tuning" else "layer"]
    return {"batch": schedule.get("batch", 1), **said}


def _rehearse(
    manifold: MotionManifold, material: Material, batch: dict[str, int], seed: int
) -> tuple[dict[str, float], int]:
    """One epoch of every stage, of a network of the same shape that nobody needs afterwards."""
    clips = clips_of(manifold, [take.positions for take in material.training])
    x = clips.evenly(REHEARSED).x
    once = Schedule(
        Stage(epochs=1, batch=batch["layer 1"]),
        Stage(epochs=1, rate=0.01, alpha=0.0, batch=batch["fine tuning"]),
    )
    network = untrained(manifold, seed).network
    history = train_autoencoder(network, x, once, np.random.default_rng(seed), show_progress=False)
    return history.seconds, len(x)
