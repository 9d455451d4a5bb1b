"""Takes longer than a clip: overlapping clips that are blended, and clips joined end to end.

The measure is the seam: the acceleration of the joints in the two frames where one clip ends and
the next begins, relative to the acceleration elsewhere.
"""

from __future__ import annotations

import numpy as np

from numpy_cae.experiments.result import Animation, Claim, Result, Table
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.manifold.long_sequences import clip_starts, project_sequence
from numpy_cae.motion import (
    ANGLE_RATE,
    PARENTS,
    POSITIONS,
    AngleSequence,
    body_positions,
    positions_to_features,
)
from numpy_cae.motion.angles import motion_of
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, Actor, strip_figure

MAX_TAKES, MAX_FRAMES = 12, 250
MAX_SEAM = 1.1
"""Acceleration at seams relative to elsewhere, above which a seam is counted as visible."""
REAL, GLUED, BLENDED = "the take itself", "clips glued together", "overlapping clips, blended"
COLOURS = {REAL: TRUTH, GLUED: CORRUPTED, BLENDED: PROJECTED}
HEADER = ("motion", "pose error, cm", "acceleration, m/s²", "at seams / elsewhere")


def long_enough(study: Study) -> list[AngleSequence]:
    """The first test takes of three clips or more."""
    least = 3 * study.manifold.settings["frames"]
    return [take for take in study.action.testing if len(take) >= least][:MAX_TAKES]


def long_takes(study: Study) -> Result:
    """Project whole test takes and measure their seams.

    Raises
    ------
    ValueError
        If no test take has three clips.
    """
    frames, takes = study.manifold.settings["frames"], long_enough(study)
    if not takes:
        raise ValueError(f"no held-out take has {3 * frames} frames")
    motions = [_motions(study, take, frames) for take in takes]
    rows = []
    for name in COLOURS:
        measured = [_measure(each, name, frames) for each in motions]
        rows.append([name, *np.mean(measured, axis=0).tolist()])
    table = Table(f"{len(takes)} held-out takes:", HEADER, rows)
    glued, blended = (table.value(name, HEADER[-1]) for name in (GLUED, BLENDED))
    action = study.action.name
    claim = Claim(
        f"Overlapping decodings of {action}, blended, have no seam: where clips begin and end, "
        f"joints accelerate at most {MAX_SEAM} times as much as elsewhere (not in jang2018, whose "
        "clips are 50 frames).",
        blended <= MAX_SEAM,
        f"{blended:.2f} times; glued together {glued:.2f} times.",
    )
    actors = [Actor(x, PARENTS, name, COLOURS[name]) for name, x in motions[0].items()]
    return Result(
        f"Whole takes of {action} on jang2018's manifold",
        [table],
        [claim],
        lambda: strip_figure(actors, ANGLE_RATE, azimuth=75.0),
        Animation(actors, ANGLE_RATE, azimuth=75.0),
    )


def _motions(study: Study, take: AngleSequence, frames: int) -> dict[str, np.ndarray]:
    """Positions (F, 20, 3) by method, of as many whole clips as there are."""

    def part(first: int, length: int) -> AngleSequence:
        numbers = take.numbers[first : first + length]
        return AngleSequence(numbers, take.table, study.manifold.offsets)

    def projected(sequence: AngleSequence) -> np.ndarray:
        return body_positions(project_sequence(study.manifold, sequence))

    length = min(len(take), MAX_FRAMES) // frames * frames
    whole = part(0, length)
    return {
        REAL: body_positions(motion_of(whole.numbers, whole.table, whole.offsets)),
        GLUED: np.concatenate([projected(part(t, frames)) for t in range(0, length, frames)]),
        BLENDED: projected(whole),
    }


def _measure(motions: dict[str, np.ndarray], name: str, frames: int) -> tuple[float, ...]:
    """Pose error in cm, acceleration away from seams in m/s², and at seams relative to that."""
    positions = motions[name]
    gap = _poses(positions) - _poses(motions[REAL])
    acceleration = np.linalg.norm(np.diff(positions, 2, axis=0), axis=-1).mean(axis=1)
    acceleration *= ANGLE_RATE**2
    overlapping = clip_starts(len(positions), frames)[1:]
    begin = overlapping if name == BLENDED else overlapping[1::2]
    # The acceleration of index t - 1 is centred on frame t.
    at_seam = np.zeros(len(acceleration), bool)
    at_seam[[t - 1 for t in begin] + [t - 2 for t in begin]] = True
    elsewhere = acceleration[~at_seam].mean()
    return 100 * np.sqrt(np.mean(gap**2)), elsewhere, acceleration[at_seam].mean() / elsewhere


def _poses(positions: np.ndarray) -> np.ndarray:
    return positions_to_features(positions, ANGLE_RATE)[0][:, POSITIONS]
