"""How often repair changes motion without damage, and how certain its findings are.

Every `every`-th file of the folders, SECONDS of its middle, and synthetic takes of fast actions, at
several rates: frames are left out where that gives the rate, else the motion is resampled. Each is
repaired as it is, also as a body of half and of twice the size; and with damage planted, of kinds
and onsets drawn at random. A finding is right if at least half of the joints and frames that it
says are damaged, or next to damage.

    python -m studies clean_motion --data cmu/asfamc bandai

docs/lab_book/evidence.md has the figures.
"""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from data_synth import make_take
from numpy_cae.cleanup import repair_motion
from numpy_cae.cleanup.interpolation import mark_missing_joints
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import find_motion_files, load_motion
from numpy_cae.motion import Motion
from numpy_cae.motion.masks import widen_runs
from studies.shared.damages import DAMAGES, EASED, ONSETS, eased
from studies.shared.result import Result, Table

SECONDS = 6.0
RATES = (24.0, 25.0, 30.0, 60.0, 120.0)
SIZES = (1.0, 0.5, 2.0)
PLANTED = (*EASED, "spikes", "dropped frames", "jitter of some joints")
FAST = ("run", "kick", "walk_with_turn", "punch", "jumping_jacks")
"""Synthetic actions with fast movements."""
SYNTHETIC_TAKES = 4
"""Of each action of `FAST` so many takes are repaired."""
CONFIDENCES = (0.5, 0.6, 0.7, 0.8, 0.9, 1.01)
"""Findings are counted between these."""
CHANGED = 0.02
"""A take is changed much if a joint moves by more than this (m), of a body of size 1."""
NEAR = 0.1
"""What is at most this far from damage counts as damaged (s)."""


def run(manifold: MotionManifold, folders: Sequence[Path], every: int = 8, seed: int = 0) -> Result:
    """Repair clean and damaged takes at all rates."""
    clean: dict[str, list[float]] = defaultdict(list)
    right: dict[tuple[float, int], list[bool]] = defaultdict(list)
    for source, number, motion in _takes(folders, every):
        for rate, take in at_rates(motion):
            for size in SIZES:
                repaired = repair_motion(scale_body(take, size), manifold)
                name = f"{source}, {rate:g} Hz, size {size:g}"
                clean[name].append(repaired.moved.max(initial=0.0) / size)
            rng = np.random.default_rng([seed, number])
            for confidence, is_right in judge_findings(take, manifold, rng):
                row = int(np.searchsorted(CONFIDENCES, confidence, "right"))
                right[rate, row].append(is_right)
    changed = []
    for name, moves in clean.items():
        moves = np.array(moves)
        changed.append([name, len(moves), np.sum(moves > 0), np.sum(moves > CHANGED)])
    return Result(
        "Clean motion, and the confidence of findings",
        [
            Table("Takes without damage.", ["", "takes", "changed", "by over 2 cm"], changed),
            Table("Of findings, right, % (and their number).", *_by_confidence(right)),
        ],
        [],
    )


def _takes(folders: Sequence[Path], every: int) -> Iterator[tuple[str, int, Motion]]:
    """Each take: its source, its number within the source, and its motion."""
    for folder in folders:
        for number, path in enumerate(find_motion_files(folder)[::every]):
            yield Path(folder).name, number, load_motion(path)
    for kind in FAST:
        for number in range(SYNTHETIC_TAKES):
            motion = make_take(kind, number, seconds=SECONDS, rate=max(RATES)).motion
            yield f"synthetic {kind.replace('_', ' ')}", number, motion


def at_rates(motion: Motion) -> list[tuple[float, Motion]]:
    """The middle of a motion at each rate up to its own."""
    first = max(0, int((motion.seconds - SECONDS) / 2 * motion.rate))
    middle = motion.at(slice(first, first + round(SECONDS * motion.rate)))
    takes = []
    for rate in RATES:
        if rate > motion.rate + 1:
            continue
        step = round(motion.rate / rate)
        if abs(step * rate - motion.rate) < 0.1:
            take = replace(middle.at(slice(None, None, step)), rate=motion.rate / step)
        else:
            take = middle.resampled(rate)
        if len(take) >= 2 * rate:
            takes.append((rate, take))
    return takes


def scale_body(motion: Motion, size: float) -> Motion:
    """The motion of a body of another size."""
    return replace(
        motion, skeleton=motion.skeleton.scaled(size), translations=size * motion.translations
    )


def judge_findings(
    take: Motion, manifold: MotionManifold, rng: np.random.Generator
) -> list[tuple[float, bool]]:
    """The confidence of each finding in a take with damage, and whether it is right."""
    kind = str(rng.choice(PLANTED))
    damaged, mask = DAMAGES[kind](take, rng)
    if kind in EASED:
        damaged = eased(take, damaged, mask, int(rng.choice(ONSETS)))
    near = widen_runs(mask, round(NEAR * take.rate))
    repaired = repair_motion(damaged, manifold)
    verdicts = []
    for finding in (*repaired.findings, *repaired.proposed):
        marked = mark_missing_joints(damaged, [finding])
        if marked.any() and finding.confidence >= CONFIDENCES[0]:
            verdicts.append((finding.confidence, bool(near[marked].mean() >= 0.5)))
    return verdicts


def _by_confidence(
    right: dict[tuple[float, int], list[bool]],
) -> tuple[list[str], list[list[object]]]:
    """The header and the rows of the second table: a row for each range of confidences."""
    rows: list[list[object]] = []
    for row in range(1, len(CONFIDENCES)):
        cells: list[object] = [f"{CONFIDENCES[row - 1]:g} to {min(CONFIDENCES[row], 1):g}"]
        for rate in RATES:
            verdicts = right[rate, row]
            if verdicts:
                cells.append(f"{100 * np.mean(verdicts):.0f} ({len(verdicts)})")
            else:
                cells.append(None)
        rows.append(cells)
    return ["confidence", *(f"{rate:g} Hz" for rate in RATES)], rows
