"""A Kinect's recording, projected: holden2015, section 7 and figure 1, centre.

The paper records a person with a Kinect and with inertial sensors at once. We have no such
recordings; `data_synth.see_with_kinect` makes of a held-out take what a Kinect would have seen,
after published figures of its errors, and the take itself is the truth. A part of the errors
cannot be told from the motion alone: a joint that is off by the same few centimetres throughout,
a floor that rises.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from data_synth import see_with_kinect
from numpy_cae.baselines import Moments
from numpy_cae.experiments.clips import (
    ALL_SHIFTS,
    NETWORK,
    Clips,
    clips_of,
    project,
    project_ends_held,
)
from numpy_cae.experiments.example import Example
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import LabelledTake, Material, evenly
from numpy_cae.experiments.repair.repair_baselines import contenders_of
from numpy_cae.experiments.split import split_of, split_takes
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import JOINTS, PARENTS
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH

CHOOSING_TAKES, TESTING_TAKES = 24, 60
"""At most, of each source, spread evenly."""
P = 0.1
"""Of the linear denoiser: what the paper trains its network to undo."""
SEEN, TRUE = "seen by the Kinect", "truth"
LINEAR = f"linear denoiser, 15 frames, p = {P}"


@dataclass(frozen=True)
class Kinect:
    """Error in cm and jitter in m/s², by source of the takes, then by method."""

    tables: dict[str, dict[str, tuple[float, float]]]
    chosen: dict[str, str]
    example: Example
    sample: str
    title: str = "Repair: a Kinect's recording"

    def text(self) -> str:
        """A table for each source of takes."""
        parts = []
        for source, table in self.tables.items():
            rows = [
                [name, f"{error:.2f}", f"{jitter:.2f}", self.chosen.get(name, "")]
                for name, (error, jitter) in table.items()
            ]
            parts.append(text_table([source, "error, cm", "jitter, m/s²", "setting"], rows))
        return "\n\n".join([*parts, self.sample])

    def findings(self) -> list[Finding]:
        """The paper's sentence, for each source; and whether a filter does as well."""
        found = []
        for source, table in self.tables.items():
            (before, shaken), (after, smooth) = table[SEEN], table[ALL_SHIFTS]
            truth = table[TRUE][1]
            others = {
                name: error
                for name, (error, _) in table.items()
                if name not in (SEEN, NETWORK, ALL_SHIFTS, TRUE)
            }
            best = min(others, key=others.__getitem__)
            found += [
                Finding(
                    f"After projection a Kinect's recording far more closely matches the truth "
                    f"(holden2015, section 7; {source} takes, a simulated Kinect; held if less "
                    f"than two thirds of the error is left).",
                    after < before * 2 / 3,
                    f"{before:.2f} cm before, {after:.2f} cm after "
                    f"({table[NETWORK][0]:.2f} without what `repair` adds).",
                ),
                Finding(
                    f"Projection brings its jitter nearer to the truth's ({source} takes).",
                    abs(smooth - truth) < abs(shaken - truth),
                    f"{shaken:.1f} m/s² before, {smooth:.1f} after, truth {truth:.1f}.",
                ),
                Finding(
                    f"Projection leaves less error than filters and linear manifolds do "
                    f"({source} takes).",
                    after < others[best],
                    f"the network {after:.2f} cm, {best} {others[best]:.2f} cm.",
                ),
            ]
        return found

    def save_picture(self, path: str | Path) -> None:
        """Strips of what was seen, its projection and the truth, PNG."""
        self.example.save_strips(path)

    def save_gif(self, path: str | Path) -> None:
        """The same three in motion."""
        self.example.save_gif(path)


def kinect(manifold: MotionManifold, material: Material, seed: int = 0) -> Kinect:
    """See held-out takes with a Kinect, repair what it saw, compare with the takes.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
    seed : int
        Of the sensor's errors.
    """
    split = split_of(manifold, material)
    linear = Moments.of(split.training.x, split.training.real).solve(1 - P)
    choosing = evenly(split_takes(material.training)[1], CHOOSING_TAKES)
    practice, practice_truth = _seen(manifold, choosing, seed + 1)
    contenders = contenders_of(split)
    best = {each.name: each.best(practice, practice_truth) for each in contenders}
    tables, example, sample = {}, None, []
    for source in sorted({take.source for take in material.testing}, reverse=True):
        takes = evenly(material.of(source).testing, TESTING_TAKES)
        seen, truth = _seen(manifold, takes, seed)
        repaired = {
            SEEN: seen,
            **{each.name: each.repair(seen, best[each.name]) for each in contenders},
            LINEAR: linear.repair(seen),
            NETWORK: project(manifold, seen),
            ALL_SHIFTS: project_ends_held(manifold, seen, manifold.shifts),
            TRUE: truth.x,
        }
        tables[source] = {name: (truth.error(x), truth.jitter(x)) for name, x in repaired.items()}
        sample.append(f"{len(takes)} {source} takes ({len(truth)} windows)")
        example = example or _example(repaired, truth)
    chosen = {name: str(setting).strip("()") for name, setting in best.items()}
    held_out = " and ".join(sample)
    text = (
        f"Measured on {held_out} that nothing was trained on, seen by a simulated Kinect. "
        f"{split.fitted()}"
    )
    return Kinect(tables, chosen, example, text)


def _seen(
    manifold: MotionManifold, takes: Sequence[LabelledTake], seed: int
) -> tuple[np.ndarray, Clips]:
    """Windows as seen, and the truth."""
    positions = [take.positions for take in takes]
    seen = [
        see_with_kinect(take, JOINTS, PARENTS, manifold.rate, np.random.default_rng([seed, number]))
        for number, take in enumerate(positions)
    ]
    return clips_of(manifold, [each.values for each in seen]).x, clips_of(manifold, positions)


def _example(repaired: dict[str, np.ndarray], truth: Clips) -> Example:
    window = truth.typical()
    alone = truth.where(np.arange(len(truth)) == window, truth.real)
    return Example.of(
        truth,
        window,
        {
            f"{label}, {alone.error(repaired[name][[window]]):.1f} cm off"
            if name != TRUE
            else label: (repaired[name], colour)
            for label, name, colour in (
                ("Kinect", SEEN, CORRUPTED),
                ("projected", ALL_SHIFTS, PROJECTED),
                ("truth", TRUE, TRUTH),
            )
        },
    )
