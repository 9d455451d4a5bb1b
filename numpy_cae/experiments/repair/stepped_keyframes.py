"""Stepped animation, every 15th frame held: holden2015, section 7, "Filling in Missing Data".

The paper projects it blindly and finds smooth transitions between the keys. Who knows which frames
are the keys can also interpolate between them, as every animation program does, or project and
keep the keys (`fill_keyframes`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from numpy_cae.baselines import Moments, interpolate_cubically, interpolate_linearly
from numpy_cae.experiments.clips import ENDS_HELD, Clips, project_ends_held
from numpy_cae.experiments.example import Example
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.repair.repair_baselines import MEDIAN, contenders_of
from numpy_cae.experiments.split import split_of
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold, fill_keyframes
from numpy_cae.motion import POSITIONS
from numpy_cae.motion.joints import JOINTS
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, TRUTH, Curve, curves_figure, save_figure

EVERY = 15
LATE = (EVERY - 1) // 2
"""Frames that a held key lags behind on average."""
P = 0.1
"""Of the linear denoiser: what the paper trains its network to undo."""
HELD, TRUE = "held", "truth"
LINEAR, CUBIC = "linear interpolation of the keys", "cubic interpolation of the keys"
FILLED = "fill_keyframes, from held keys"
FILLED_LINE = "fill_keyframes, from a line"
TOLD = (LINEAR, CUBIC, FILLED, FILLED_LINE)


@dataclass(frozen=True)
class Row:
    """Error against the truth and against the truth `LATE` frames before, cm; jitter, m/s²."""

    error: float
    late: float
    jitter: float


@dataclass(frozen=True)
class SteppedKeyframes:
    """What each method does, and the setting of each that has one."""

    rows: dict[str, Row]
    chosen: dict[str, str]
    example: Example
    sample: str
    title: str = "Filling in: stepped keyframes"

    def text(self) -> str:
        """One table: who is told which frames are keys, and who is not."""
        lines = [
            [
                name,
                "" if name == TRUE else "yes" if name in TOLD else "no",
                f"{row.error:.2f}",
                f"{row.late:.2f}",
                f"{row.jitter:.2f}",
                self.chosen.get(name, ""),
            ]
            for name, row in self.rows.items()
        ]
        header = ["method", "told the keys", "error, cm", "late, cm", "jitter, m/s²", "setting"]
        return (
            f"Every {EVERY}th frame is held until the next, all 63 features of it; measured up to "
            f"the last key. A held key is late, by {LATE} frames on average, and who does not know "
            f'the keys cannot know that: "late" is the error against the truth of {LATE} frames '
            f"before.\n\n{text_table(header, lines)}\n\n{self.sample}"
        )

    def findings(self) -> list[Finding]:
        """Smooth transitions, nearer to the motion; and whether the keys had better be joined."""
        held, network, truth = self.rows[HELD], self.rows[ENDS_HELD], self.rows[TRUE].jitter
        filled = min(self.rows[name].error for name in (FILLED, FILLED_LINE))
        best = min((LINEAR, CUBIC), key=lambda name: self.rows[name].error)
        return [
            Finding(
                "Projection inserts smooth transitions between stepped keyframes (holden2015, "
                "section 7; held if the jitter comes within half of the truth's).",
                abs(network.jitter - truth) < truth / 2,
                f"{held.jitter:.1f} m/s² held, {network.jitter:.1f} projected, truth {truth:.1f}.",
            ),
            Finding(
                "What it inserts corresponds to motion (section 7; held if it is nearer to the "
                "true motion than the held keys are, in time or late).",
                network.error < held.error and network.late < held.late,
                f"{held.error:.2f} cm held, {network.error:.2f} cm projected; late "
                f"{held.late:.2f} and {network.late:.2f} cm.",
            ),
            Finding(
                "It is nearer to the true motion than interpolation of the keys (not in the "
                "paper).",
                filled < self.rows[best].error,
                f"{best} {self.rows[best].error:.2f} cm; the network {network.error:.2f} cm blind "
                f"({network.late:.2f} cm late), {filled:.2f} cm told which frames are keys.",
            ),
        ]

    def save_picture(self, path: str | Path) -> None:
        """The coordinate that moves most, over time: truth, held, interpolated, projected, PNG."""
        motions = self.example.motions
        column = int(np.argmax(np.ptp(motions[TRUE][0][:, POSITIONS], axis=0)))
        name = f"{JOINTS[column // 3]} {'xyz'[column % 3]}".replace("_", " ")
        styles = {TRUE: "-", HELD: "-", LINEAR: ":", CUBIC: "--"}
        curves = [
            Curve(
                np.arange(len(features)) / self.example.rate,
                100 * features[:, column],
                label,
                colour,
                styles.get(label, "-"),
            )
            for label, (features, colour) in motions.items()
        ]
        save_figure(curves_figure(curves, "time, s", f"{name}, cm", (9.5, 4.0)), path)

    def save_gif(self, path: str | Path) -> None:
        """Held, projected, true."""
        shown = {label: self.example.motions[label] for label in (HELD, ENDS_HELD, TRUE)}
        replace(self.example, motions=shown).save_gif(path)


def stepped_keyframes(
    manifold: MotionManifold, material: Material, seed: int = 0
) -> SteppedKeyframes:
    """Hold every 15th frame of held-out windows and fill in what lies between.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
    seed : int
        Nothing is drawn; every experiment takes one.
    """
    split = split_of(manifold, material)
    choosing, testing = _up_to_last_key(split.choosing), _up_to_last_key(split.testing)
    moments = Moments.of(split.training.x, split.training.real)
    keys = np.arange(0, testing.x.shape[1], EVERY)
    held, practice = _held(testing.x), _held(choosing.x)
    filled, chosen = {HELD: held}, {}
    for contender in contenders_of(split):
        if contender.name == MEDIAN:
            continue  # the median of a stair is the stair
        setting = contender.best(practice, choosing)
        filled[contender.name] = contender.repair(held, setting)
        chosen[contender.name] = str(setting).strip("()")
    filled[f"linear denoiser, 15 frames, p = {P}"] = moments.solve(1 - P).repair(held)
    filled[ENDS_HELD] = project_ends_held(manifold, held)
    known = np.zeros(testing.x.shape, dtype=bool)
    known[:, keys] = True
    filled[LINEAR] = interpolate_linearly(held, known)
    filled[CUBIC] = interpolate_cubically(held, keys)
    for name, start in ((FILLED, "held"), (FILLED_LINE, "line")):
        filled[name] = testing.each(
            lambda x, start=start: fill_keyframes(manifold, x, EVERY, start)
        )
    filled[TRUE] = testing.x
    late = testing.later(LATE)
    rows = {
        name: Row(testing.error(x), late.error(x), testing.jitter(x)) for name, x in filled.items()
    }
    colours = {HELD: CORRUPTED, LINEAR: PLAIN, CUBIC: PLAIN, ENDS_HELD: PROJECTED, TRUE: TRUTH}
    motions = {name: (filled[name], colour) for name, colour in colours.items()}
    example = Example.of(testing, testing.typical(), motions)
    return SteppedKeyframes(rows, chosen, example, split.text())


def _held(x: np.ndarray) -> np.ndarray:
    frames = np.arange(x.shape[1])
    return x[:, frames - frames % EVERY]


def _up_to_last_key(clips: Clips) -> Clips:
    """Only the frames that lie between two keys count; windows too short for two go."""
    frames = np.count_nonzero(clips.real, axis=1)
    last = (frames - 1) // EVERY * EVERY
    between = np.arange(clips.real.shape[1]) <= last[:, None]
    return clips.where(last > 0, between)
