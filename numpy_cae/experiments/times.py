"""Computational time, holden2015, section 7: training stage by stage, and projection.

A model file records how long each stage of its training took. The paper had 9673 windows and 25
epochs for each layer; the recorded minutes are scaled to those numbers, as they are proportional
to them. Projection is timed on this machine.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from numpy_cae.bench.paper import EPOCHS, MINUTES, WINDOWS
from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.fast import accelerate
from numpy_cae.manifold import MotionManifold
from numpy_cae.viz import PLAIN, PROJECTED, bars_figure

ROUNDS = 15
ENCODE, PROJECT, WHOLE = "Φ(X), a window", "Φ†(Φ(X)), a window", "Φ†(Φ(X)), a whole take"
SCALED = f"of {WINDOWS} windows × {EPOCHS} epochs"
STAGES = ("stage", "epochs", "batch", "minutes", SCALED, "paper")
FORMATS = ("", "", "", ".3g", ".1f", "")


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Read how long training took, and time the projection of the test take of median length.

    Raises ValueError where no take is held out or the model does not record its training times.
    """
    if not material.testing:
        raise ValueError("times needs a held-out take to project, there is none")
    settings = manifold.settings
    if not settings.get("seconds"):
        raise ValueError("the model does not record how long its training took")
    rows = [_stage(settings, stage) for stage in settings["seconds"]]
    minutes, scaled, paper = (sum(row[column] or 0 for row in rows) for column in (3, 4, 5))
    rows.append(["all", None, None, minutes, scaled, paper])

    lengths = [len(take.positions) for take in material.testing]
    take = material.testing[int(np.argsort(lengths)[len(lengths) // 2])].positions
    window = clips_of(manifold, [take]).x[:1]
    features = manifold.features(take)[0]
    network = accelerate(manifold.network)
    milliseconds = {
        ENCODE: _median_milliseconds(lambda: network.encode(window)),
        PROJECT: _median_milliseconds(lambda: network.project(window)),
        WHOLE: _median_milliseconds(lambda: manifold.project(features)),
    }
    trained = f"Training, as the model recorded it, on {settings['windows']} windows:"
    timed = f"Projection; a window has {window.shape[1]} frames, the take {len(take)}:"
    return Result(
        "Computational time",
        [
            Table(trained, STAGES, rows, FORMATS),
            Table(timed, ["what", "milliseconds"], list(map(list, milliseconds.items()))),
        ],
        [
            Claim(
                "Training the full network takes 5 hours and 4 minutes (holden2015, section 7, on "
                "a Quadro K2000); held if it takes no longer here.",
                scaled <= sum(MINUTES.values()),
                f"{scaled / 60:.1f} hours, scaled from {settings['windows']} windows to {WINDOWS} "
                f"and to {EPOCHS} epochs of each stage, against {sum(MINUTES.values()) / 60:.1f}.",
            ),
            Claim(
                "Projection can be done in a fraction of a millisecond (holden2015, section 7).",
                milliseconds[ENCODE] < 1,
                f"Φ of a window takes {milliseconds[ENCODE]:.2f} ms, Φ and Φ† together "
                f"{milliseconds[PROJECT]:.2f} ms.",
            ),
        ],
        lambda: _figure(rows),
    )


def _stage(settings: dict, stage: str) -> list:
    """The row of a training stage."""
    schedule = settings["schedule"]["fine_tuning" if stage == "fine tuning" else "layer"]
    epochs, minutes = schedule["epochs"], settings["seconds"][stage] / 60
    shown = settings["windows"] * epochs
    scaled = minutes * WINDOWS * EPOCHS / shown if shown else None
    return [stage, epochs, schedule["batch"], minutes, scaled, MINUTES.get(stage)]


def _median_milliseconds(call: Callable[[], object]) -> float:
    call()
    seconds = []
    for _ in range(ROUNDS):
        started = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - started)
    return 1e3 * float(np.median(seconds))


def _figure(rows: list[list]):
    """Minutes of each stage, scaled, beside the paper's."""
    stages = rows[:-1]
    return bars_figure(
        [row[0] for row in stages],
        [
            ("here, scaled", [row[4] or 0 for row in stages], PROJECTED),
            ("the paper", [row[5] or 0 for row in stages], PLAIN),
        ],
        f"minutes of training: {WINDOWS} windows, {EPOCHS} epochs",
    )
