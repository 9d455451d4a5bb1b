"""How well damage is found, kind by kind, at 24 to 120 Hz, with onsets of 0 to 8 frames.

Clips of SECONDS from takes of the folders, and synthetic ones, are repaired as they are, with up to
three planted events (`studies/explaining/planted.py`), with a cut, and with a leg that is turned at
the same place and by the same turn with each onset. Recall, precision and calibration are those of
`studies/explaining/scoring.py`.

    python -m studies explanations --data cmu/asfamc bandai real
    python -m studies explanations --data cmu/asfamc bandai real --finder likelihood

The finder by likelihood (`studies/explaining/likelihood.py`) has its numbers from takes of CMU.
docs/lab_book/explanations.md has the findings.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from data_synth import KINDS, make_take
from numpy_cae.cleanup import repair_motion
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import find_motion_files, load_motion
from numpy_cae.motion import Motion
from studies.explaining.mending import explain_and_mend
from studies.explaining.planted import (
    ONSETS,
    NoPlaceError,
    Planted,
    clip_of,
    mean_distance,
    plant_cut,
    plant_several,
    turn_joint,
)
from studies.explaining.scoring import CONFIDENCES, Case, Method, Outcome, Score, mean
from studies.shared.messages import note
from studies.shared.result import Result, Table

SECONDS = 6.0
RATES = (24.0, 30.0, 60.0, 90.0, 120.0)
PLANTED = ("spike", "turned", "root offset", "hold", "arm held")
"""The kinds of events of which a clip has several."""
MOST_EVENTS = 3
EVENT_SECONDS = 1.8
"""A clip has at most `MOST_EVENTS` events, and one in this time (s) at most."""
CLEAN_FILES = ("clean_mocapbank.bvh", "clean_freebvh.bvh", "xsens_walk.bvh")
"""Of a folder that has these files only these are clean; others are left out."""
LEG_TAKES = 3
LEG_SECONDS = 0.67
LEG_DEGREES = 50.0
LEAST_LEG_METRES = 0.2
"""A leg is turned by `LEG_DEGREES` for `LEG_SECONDS`, by a turn that moves its joints by at least
this (m) in the mean."""
LEG_SPIKE_DEGREES = 60.0
"""The spike of the hip in the middle of a turned leg."""
ISOLATED_RATIO = 2.0
ISOLATED_CM = 2.0
"""An onset is worse than its neighbours if the error is more than this times the larger one of
theirs, and more than this (cm)."""


class Leg:
    """A turned leg with each onset: the errors (cm) before and after mending, by onset; with a
    spike in the middle of the turn without onset; NaN where the clip has no place."""

    def __init__(self, rate: float):
        self.rate = rate
        self.before: list[float] = []
        self.after: list[float] = []
        self.with_spike = float("nan")


def run(
    manifold: MotionManifold,
    folders: Sequence[Path],
    takes: int = 12,
    finder: str = "repair",
    seed: int = 0,
) -> Result:
    """Repair clips of at most `takes` takes of each source with one of `FINDERS`; `seed` draws the
    damage."""
    if takes < 1:
        raise ValueError(f"--takes is {takes}, expected 1 or more")
    if finder not in FINDERS:
        raise ValueError(f"no finder {finder}: --finder is one of {', '.join(FINDERS)}")
    method = partial(FINDERS[finder], manifold=manifold)
    scores = {}
    legs = {}
    for source, motions in sources(folders, takes).items():
        note(f"{source} is measured")
        scores[source] = score_of(method, source, motions, seed)
        legs[source] = list(turned_legs(method, motions, seed))
    return Result(f"Planted damage, found by {finder}", tables(scores, legs))


def find_by_repair(motion: Motion, manifold: MotionManifold) -> Outcome:
    """What `repair` finds, and makes of a motion."""
    repaired = repair_motion(motion, manifold)
    findings = [*repaired.findings, *repaired.proposed]
    findings = [finding for finding in findings if finding.status != "kept"]
    return Outcome(findings, repaired.cuts, repaired.motion, float(repaired.moved.max(initial=0.0)))


FINDERS: dict[str, Callable[..., Outcome]] = {
    "repair": find_by_repair,
    "likelihood": explain_and_mend,
}
"""The ways to find and mend damage: that of `repair`, and that of `studies/explaining`."""


def sources(folders: Sequence[Path], takes: int) -> dict[str, list[Motion]]:
    """Takes of each folder, evenly chosen, and synthetic ones."""
    motions = {}
    for folder in folders:
        paths = find_motion_files(folder)
        clean = [path for path in paths if path.name in CLEAN_FILES]
        paths = clean or paths
        numbers = np.unique(np.linspace(0, len(paths) - 1, takes).astype(int))
        motions[Path(folder).parts[-1]] = [load_motion(paths[number]) for number in numbers]
    synthetic = []
    for number in range(takes):
        kind = KINDS[number % len(KINDS)]
        synthetic.append(make_take(kind, 100 + number, seconds=SECONDS, rate=max(RATES)).motion)
    motions["synthetic"] = synthetic
    return motions


def clips(motions: Sequence[Motion], rates: int) -> Iterator[tuple[int, float, Motion]]:
    """Clips of takes at some of `RATES` each, with the number of the take and the rate."""
    for number, motion in enumerate(motions):
        possible = [rate for rate in RATES if rate <= motion.rate + 1]
        for i in range(min(rates, len(possible))):
            rate = possible[(number + i * (1 + len(possible) % 2)) % len(possible)]
            clip = clip_of(motion, rate, SECONDS)
            if clip is not None:
                yield number, rate, clip


def cases(source: str, motions: Sequence[Motion], seed: int) -> Iterator[Case]:
    """Clips with several events, and clips with a cut."""
    for number, rate, clip in clips(motions, 2):
        rng = np.random.default_rng([seed, number, int(rate)])
        count = min(MOST_EVENTS, max(1, int(clip.seconds / EVENT_SECONDS)))
        kinds = [PLANTED[k] for k in rng.permutation(len(PLANTED))[:count]]
        onset = int(rng.choice(ONSETS))
        damaged, events = plant_several(clip, kinds, onset, rng)
        yield Case(source, rate, onset, clip, damaged, events)
    for number, rate, clip in clips(motions, 1):
        rng = np.random.default_rng([seed, number, int(rate), 1])
        joined, event = plant_cut(clip, slice(0, len(clip)), rng)
        yield Case(source, rate, 0, joined, joined, [event])


def score_of(method: Method, source: str, motions: Sequence[Motion], seed: int) -> Score:
    """What a method finds in the clips of a source, clean and damaged."""
    score = Score()
    for _, _, clip in clips(motions, len(RATES)):
        score.add_clean(method(clip))
    for case in cases(source, motions, seed):
        score.add(case, method(case.damaged))
    return score


def turned_legs(method: Method, motions: Sequence[Motion], seed: int) -> Iterator[Leg]:
    """A turned leg of every `LEG_TAKES`-th take at each rate, mended by a method."""
    for number, rate, clip in clips(motions[::LEG_TAKES], len(RATES)):
        rng = np.random.default_rng([seed, number, 2])
        try:
            core, vector, in_parent = draw_leg(clip, rng)
        except NoPlaceError:
            continue
        leg = Leg(rate)
        for onset in ONSETS:
            first = core.first - onset
            event = core._replace(first=first, last=core.last + onset, onset=onset)
            damaged = turn_joint(clip, event, vector, in_parent)
            leg.before.append(100 * mean_distance(damaged, clip, core))
            leg.after.append(100 * mean_distance(method(damaged).motion, clip, core))
        middle = (core.first + core.last) // 2
        spike = Planted("spike", core.joint, middle, middle)
        damaged = turn_joint(clip, core, vector, in_parent)
        damaged = turn_joint(damaged, spike, np.radians([0.0, 0.0, LEG_SPIKE_DEGREES]), False)
        leg.with_spike = 100 * mean_distance(method(damaged).motion, clip, core)
        yield leg


def draw_leg(clip: Motion, rng: np.random.Generator) -> tuple[Planted, np.ndarray, bool]:
    """A hip, the frames in which it is turned without the onsets, its turn, and whether that is in
    the frame of its parent; the same for a motion at any rate."""
    joint = str(rng.choice(["left_hip", "right_hip"]))
    length = round(LEG_SECONDS * clip.rate)
    margin = max(ONSETS) + round(0.3 * clip.rate)
    room = len(clip) - length - 2 * margin
    if room < 1:
        raise NoPlaceError("the frames are too few")
    first = margin + int(rng.random() * room)
    event = Planted("turned", joint, first, first + length - 1)
    in_parent = bool(rng.random() < 0.5)
    for _ in range(20):
        direction = rng.normal(size=3)
        vector = np.radians(LEG_DEGREES) * direction / np.linalg.norm(direction)
        turned = turn_joint(clip, event, vector, in_parent)
        if mean_distance(turned, clip, event) >= LEAST_LEG_METRES:
            return event, vector, in_parent
    raise NoPlaceError("no turn moves the leg enough")


def tables(scores: dict[str, Score], legs: dict[str, list[Leg]]) -> list[Table]:
    """The tables of the study."""
    return [
        by_kind(scores),
        by_rate_and_onset(scores),
        by_confidence(scores),
        by_source(scores),
        by_leg(legs),
    ]


def by_kind(scores: dict[str, Score]) -> Table:
    """Recall and errors of each kind and source."""
    rows: list[list[object]] = []
    for kind in (*PLANTED, "cut"):
        for source, score in scores.items():
            events = score.chosen(kind=kind)
            if not events:
                continue
            row: list[object] = [f"{kind}, {source}", len(events)]
            row += [score.recall(confidence, kind=kind) for confidence in CONFIDENCES]
            row.append(mean([event.before for event in events]))
            row.append(mean([event.after for event in events]))
            rows.append(row)
    header = ["", "events", *(f"found at {sure}" for sure in CONFIDENCES), "cm", "cm after"]
    formats = [".2f"] * (2 + len(CONFIDENCES)) + [".1f"] * 2
    return Table(
        "Events by kind: share found at a confidence, error before and after.",
        header,
        rows,
        formats,
    )


def by_rate_and_onset(scores: dict[str, Score]) -> Table:
    """Recall at 0.5 of what has an onset, by rate and onset, over all sources."""
    rows: list[list[object]] = []
    for rate in RATES:
        row: list[object] = [f"{rate:g} Hz"]
        for onset in ONSETS:
            confidences = []
            for score in scores.values():
                for event in score.chosen(rate=rate, onset=onset):
                    if event.kind not in ("spike", "cut"):
                        confidences.append(event.confidence)
            row.append(mean([confidence >= 0.5 for confidence in confidences]))
        rows.append(row)
    header = ["", *(f"onset {onset}" for onset in ONSETS)]
    return Table("Share found at 0.5 of turns, offsets and holds, all sources.", header, rows)


def by_confidence(scores: dict[str, Score]) -> Table:
    """Calibration: of the findings of each range of confidences the share that is right."""
    rows: list[list[object]] = []
    for source, score in scores.items():
        for sure, right, number in score.calibration():
            rows.append([source, number, sure, right])
    header = ["", "findings", "mean confidence", "right"]
    return Table("Confidence of findings, and the share that is right.", header, rows)


def by_source(scores: dict[str, Score]) -> Table:
    """Precision, and what is done to clean motion."""
    rows: list[list[object]] = []
    for source, score in scores.items():
        row: list[object] = [source]
        for confidence in CONFIDENCES:
            row += [
                score.precision(confidence),
                mean([e.confidence >= confidence for e in score.events]),
            ]
        moved = np.array(score.clean_moved)
        row += [
            len(moved),
            int(np.sum(moved > 0)),
            int(np.sum(moved > 0.02)),
            len(score.clean_findings),
        ]
        row.append(int(np.sum(np.array(score.cut_changes) > 0.02)))
        rows.append(row)
    header = [""]
    for confidence in CONFIDENCES:
        header += [f"precision {confidence}", f"recall {confidence}"]
    header += ["clean", "changed", "by 2 cm", "findings", "cuts changed by 2 cm"]
    return Table("Precision and recall; clean clips that are changed.", header, rows)


def by_leg(legs: dict[str, list[Leg]]) -> Table:
    """Errors of the turned leg by source, rate and onset."""
    rows: list[list[object]] = []
    for source, of_source in legs.items():
        for rate in RATES:
            some = [leg for leg in of_source if leg.rate == rate]
            if not some:
                continue
            after = np.array([leg.after for leg in some])
            row: list[object] = [
                f"{source}, {rate:g} Hz",
                len(some),
                np.mean([leg.before for leg in some]),
            ]
            row += after.mean(axis=0).tolist()
            row.append(int(sum(is_isolated(errors) for errors in after)))
            row.append(mean([leg.with_spike - leg.after[0] for leg in some]))
            rows.append(row)
    header = [
        "",
        "files",
        "damaged",
        *(f"onset {onset}" for onset in ONSETS),
        "isolated",
        "spike adds",
    ]
    return Table(
        "A leg turned by 50°: error (cm) of its joints after mending.", header, rows, ".1f"
    )


def is_isolated(errors: np.ndarray) -> bool:
    """Whether the error (cm) of an onset is far above those of the onsets before and after it."""
    for i, error in enumerate(errors):
        neighbours = [errors[j] for j in (i - 1, i + 1) if 0 <= j < len(errors)]
        if error > max(ISOLATED_CM, ISOLATED_RATIO * max(neighbours)):
            return True
    return False
