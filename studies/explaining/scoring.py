"""How well a finder finds planted events: recall and precision by confidence, calibration, and what
is left after mending.

A finding is right if its joint is that of an event, or one that it moves, and at least half of the
finding's frames are frames of the event or within `NEAR_SECONDS` of it. An event is found if a
right finding of its joint covers at least half of its frames. What moves the whole body is found by
a finding of the root or of the body, a cut by a cut within a frame.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from numpy_cae.cleanup import Finding
from numpy_cae.motion import JOINTS, Motion
from studies.explaining.planted import Planted, mean_distance, moved_joints

NEAR_SECONDS = 0.1
CONFIDENCES = (0.5, 0.7, 0.9)
"""Recall and precision are of findings with at least these confidences."""
BINS = (0.5, 0.6, 0.7, 0.8, 0.9, 1.001)
"""Calibration is of findings with confidences between two of these."""
CHANGED_METRES = 0.02


class Outcome(NamedTuple):
    """What a method made of a motion: all findings with their confidences, mended or not, the first
    frames of other clips, the mended motion, and how far a joint moved at most (m)."""

    findings: Sequence[Finding]
    cuts: Sequence[int]
    motion: Motion
    moved: float


Method = Callable[[Motion], Outcome]


class Case(NamedTuple):
    """A motion with planted events: its source, its rate, the onset, the truth, what a method is
    given, and the events."""

    source: str
    rate: float
    onset: int
    truth: Motion
    damaged: Motion
    events: Sequence[Planted]


class EventScore(NamedTuple):
    """The largest confidence with which an event was found (0: not found), and the mean error (cm)
    of the joints that it moves before and after mending."""

    kind: str
    rate: float
    onset: int
    confidence: float
    before: float
    after: float


@dataclass
class Score:
    """The scores of a method on the cases of one source."""

    events: list[EventScore] = field(default_factory=list)
    findings: list[tuple[float, bool]] = field(default_factory=list)
    """The confidence of each finding in the damaged motions, and whether it is right."""
    clean_findings: list[float] = field(default_factory=list)
    """The confidences of the findings in clean motions."""
    clean_moved: list[float] = field(default_factory=list)
    """How far a joint of each clean motion was moved at most (m)."""
    cut_changes: list[float] = field(default_factory=list)
    """How far a joint was moved at most (m) in each motion whose only event is a cut."""

    def add_clean(self, outcome: Outcome) -> None:
        """Count what a method made of a clean motion."""
        self.clean_findings += [finding.confidence for finding in outcome.findings]
        self.clean_findings += [1.0] * len(outcome.cuts)
        self.clean_moved.append(outcome.moved)

    def add(self, case: Case, outcome: Outcome) -> None:
        """Count what a method made of a case."""
        near = round(NEAR_SECONDS * case.rate)
        for event in case.events:
            if event.kind == "cut":
                found = float(any(abs(cut - event.first) <= 1 for cut in outcome.cuts))
                self.events.append(EventScore("cut", case.rate, event.onset, found, 0.0, 0.0))
                self.cut_changes.append(outcome.moved)
                continue
            confidences = [0.0]
            for finding in outcome.findings:
                if is_right(finding, event, near) and covers(finding, event):
                    confidences.append(finding.confidence)
            before = 100 * mean_distance(case.damaged, case.truth, event)
            after = 100 * mean_distance(outcome.motion, case.truth, event)
            self.events.append(
                EventScore(event.kind, case.rate, event.onset, max(confidences), before, after)
            )
        for finding in outcome.findings:
            right = any(is_right(finding, event, near) for event in case.events)
            self.findings.append((finding.confidence, right))
        cuts = [event.first for event in case.events if event.kind == "cut"]
        for cut in outcome.cuts:
            self.findings.append((1.0, any(abs(cut - first) <= 1 for first in cuts)))

    def recall(self, confidence: float, **where: object) -> float:
        """The share of the events that were found with at least a confidence; `where` are values of
        `EventScore` that the events have. NaN without events."""
        events = self.chosen(**where)
        return mean([event.confidence >= confidence for event in events])

    def chosen(self, **where: object) -> list[EventScore]:
        """The events with some values."""
        events = []
        for event in self.events:
            if all(getattr(event, name) == value for name, value in where.items()):
                events.append(event)
        return events

    def precision(self, confidence: float) -> float:
        """The share of the findings with at least a confidence, in damaged motions, that are
        right."""
        return mean([right for sure, right in self.findings if sure >= confidence])

    def calibration(self) -> list[tuple[float, float, int]]:
        """For each of `BINS` the mean confidence of the findings, the share that is right, and
        their number; findings in clean motions are wrong."""
        findings = [*self.findings, *((sure, False) for sure in self.clean_findings)]
        rows = []
        for low, high in pairwise(BINS):
            inside = [(sure, right) for sure, right in findings if low <= sure < high]
            rows.append((mean([x[0] for x in inside]), mean([x[1] for x in inside]), len(inside)))
        return rows


def is_right(finding: Finding, event: Planted, near: int) -> bool:
    """Whether a finding is about an event, by the module's rule; `near` is in frames."""
    if event.kind == "cut":
        return finding.frames[0] <= event.first + 1 and finding.frames[1] >= event.first - 1
    frames = np.arange(finding.frames[0], finding.frames[1] + 1)
    is_inside = (frames >= event.first - near) & (frames <= event.last + near)
    return is_inside.mean() >= 0.5 and finding.joint in _names_of(event)


def covers(finding: Finding, event: Planted) -> bool:
    """Whether a finding is of the joint of an event, and of at least half of its frames."""
    first = max(finding.frames[0], event.first)
    last = min(finding.frames[1], event.last)
    names = _names_of(event)[:2]
    return 2 * (last + 1 - first) >= event.last + 1 - event.first and finding.joint in names


def _names_of(event: Planted) -> list[str]:
    """The joint of an event and what a finding about it may name instead: the elbow of an arm that
    is held, the body or the hips where all moves; then the joints that it moves."""
    moved = [JOINTS[column] for column in moved_joints(event.joint)]
    if event.joint not in JOINTS[1:]:
        return [event.joint, "body", *moved]
    alias = event.joint.replace("shoulder", "elbow") if event.kind == "arm held" else event.joint
    return [event.joint, alias, *moved]


def mean(values: Sequence[float]) -> float:
    """The mean; NaN of no values."""
    return float(np.mean(values)) if len(values) else float("nan")
