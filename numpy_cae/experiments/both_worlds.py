"""A motion from both worlds: samples of jang2018's sequential manifold, projected onto holden2015's
convolutional one. Does that mend their drift?

The decoder of a sequence feeds on its own frames, and writes from the last to the first; what goes
wrong early is carried along. So drift is looked for as what grows from the half of a clip that is
written first, its end, to the half that is written last:

near      how far poses are from the nearest pose of real training clips, cm, in both halves
sliding   of the standing foot; jitter; bone lengths, which angles keep by themselves
clip      the distance to the nearest held-out clip, root mean square of the pose features, cm

each before, after a plain and after a constrained projection, and the same of real clips.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np

from numpy_cae.experiments.figure_3 import FITTED, REAL, sampled
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequence_study import Study
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold, project_constrained
from numpy_cae.measures import ValidityMeasure, clip_distances
from numpy_cae.motion import (
    PARENTS,
    POSITIONS,
    Place,
    body_of,
    features_to_positions,
)
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, Actor, save_figure, save_gif, strip_figure

CLIPS, OTHERS = 40, 400
"""Clips measured, and real ones that they are held against."""
STEPS = 60
SAMPLED, REAL_CLIPS = "samples", "real clips"
NOT, PLAINLY, CONSTRAINED = "as they are", "projected", "projected, constrained"


@dataclass(frozen=True)
class Row:
    """Means over clips."""

    first_written: float
    last_written: float
    sliding: float
    jitter: float
    bones: float
    clip: float

    HEADER = (
        "near, written first, cm",
        "written last, cm",
        "sliding, cm/s",
        "jitter, m/s²",
        "bone length, cm",
        "nearest clip, cm",
    )


@dataclass(frozen=True)
class BothWorlds:
    """The table of one action, and one sample as positions (F, 20, 3)."""

    action: str
    rows: dict[str, Row]
    shown: dict[str, np.ndarray]
    rate: float

    @property
    def title(self) -> str:
        """What is told."""
        return f"Samples of {self.action} from the sequential manifold on the convolutional one"

    def text(self) -> str:
        """For a terminal."""
        digits = (2, 2, 1, 2, 2, 2)
        rows = [
            [name, *(f"{v:.{n}f}" for v, n in zip(astuple(row), digits, strict=True))]
            for name, row in self.rows.items()
        ]
        return text_table(["clips", *Row.HEADER], rows)

    def findings(self) -> list[Finding]:
        """Whether it mends drift, and feet."""
        rows = {way: self.rows[f"{SAMPLED}, {way}"] for way in (NOT, PLAINLY, CONSTRAINED)}
        before, plain, kept = rows.values()
        real = self.rows[f"{REAL_CLIPS}, {NOT}"]
        grown = [row.last_written - row.first_written for row in rows.values()]
        return [
            Finding(
                f"Samples of {self.action} drift: the half of a clip that is written last is "
                "farther from real poses than the half written first.",
                before.last_written > before.first_written,
                f"{before.first_written:.2f} cm, then {before.last_written:.2f}; real clips "
                f"{real.first_written:.2f} and {real.last_written:.2f}.",
            ),
            Finding(
                "Projected onto the convolutional manifold they drift less and lie nearer to real "
                "clips.",
                plain.last_written < before.last_written and plain.clip < before.clip,
                f"poses written last {before.last_written:.2f} cm before, {plain.last_written:.2f} "
                f"projected, {kept.last_written:.2f} constrained (grown by {grown[0]:+.2f}, "
                f"{grown[1]:+.2f}, {grown[2]:+.2f}); nearest clip {before.clip:.2f}, "
                f"{plain.clip:.2f}, {kept.clip:.2f} cm.",
            ),
            Finding(
                "A constrained projection mends their feet: half of the sliding, at no more than a "
                "tenth of distance to the nearest clip.",
                kept.sliding < before.sliding / 2 and kept.clip < 1.1 * before.clip,
                f"sliding {before.sliding:.1f} cm/s before, {plain.sliding:.1f} projected, "
                f"{kept.sliding:.1f} constrained, of real clips {real.sliding:.1f}; jitter "
                f"{before.jitter:.2f}, {plain.jitter:.2f}, {kept.jitter:.2f}, {real.jitter:.2f}.",
            ),
        ]

    def save_picture(self, path: str | Path) -> None:
        """Strips of one sample."""
        save_figure(strip_figure(self._actors(), self.rate, azimuth=75.0), path)

    def save_gif(self, path: str | Path) -> None:
        """The same, moving."""
        save_gif(self._actors(), path, self.rate, azimuth=75.0)

    def _actors(self) -> list[Actor]:
        colours = {NOT: CORRUPTED, PLAINLY: PLAIN, CONSTRAINED: PROJECTED}
        return [Actor(x, PARENTS, name, colours[name]) for name, x in self.shown.items()]


def both_worlds(study: Study, manifold: MotionManifold, seed: int = 0) -> BothWorlds:
    """Draw, project, measure.

    Parameters
    ----------
    study : Study
        Of the sequential manifold.
    manifold : MotionManifold
        The convolutional one, learned from motions of any kind.
    seed : int
        Of what is drawn.
    """
    drawn = sampled(study, CLIPS, seed)
    clips = {SAMPLED: drawn[FITTED], REAL_CLIPS: drawn[REAL]}
    training = _features(study, manifold, study.drawn(OTHERS, seed + 1))
    held_out = _features(study, manifold, study.drawn(OTHERS, seed + 2, training=False))
    measure = ValidityMeasure([each for each, _ in training], manifold.lengths, manifold.rate)
    real = np.stack([each[:, POSITIONS] for each, _ in held_out])
    rows, shown = {}, {}
    for source, made in clips.items():
        features = _features(study, manifold, made)
        for way, project in _WAYS.items():
            projected = [project(manifold, x, start) for x, start in features]
            rows[f"{source}, {way}"] = _row(projected, measure, real)
            if source == SAMPLED:
                shown[way] = features_to_positions(projected[0], features[0][1])
    return BothWorlds(study.action.name, rows, shown, manifold.rate)


_WAYS = {
    NOT: lambda manifold, x, start: x,
    PLAINLY: lambda manifold, x, start: manifold.project(x, manifold.shifts),
    CONSTRAINED: lambda manifold, x, start: project_constrained(manifold, x, start, steps=STEPS),
}


def _features(
    study: Study, manifold: MotionManifold, clips: np.ndarray
) -> list[tuple[np.ndarray, Place]]:
    """Of clips at 25 frames a second, on the convolutional manifold's mean skeleton at 30."""
    return [manifold.features(body_of(study.manifold.motion(clip))) for clip in clips]


def _row(clips: list[np.ndarray], measure: ValidityMeasure, real: np.ndarray) -> Row:
    half = len(clips[0]) // 2
    valid = [measure.of(clip) for clip in clips]
    poses = np.stack([clip[:, POSITIONS] for clip in clips])
    return Row(
        float(np.mean([measure.nearest.mean_distance(clip[half:]) for clip in clips])),
        float(np.mean([measure.nearest.mean_distance(clip[:half]) for clip in clips])),
        float(np.mean([each.foot_sliding for each in valid])),
        float(np.mean([each.jitter for each in valid])),
        float(np.mean([each.bone_length for each in valid])),
        100 * float(clip_distances(poses, real).min(axis=1).mean()),
    )
