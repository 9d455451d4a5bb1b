"""Events: the findings along one limb whose frames overlap, as of an elbow and its wrist in one
swing. Wherever findings are listed, those of an event are together, the largest event first."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from numpy_cae.cleanup.finding import STATUSES, Finding
from numpy_cae.motion.joints import SIDES

_JOINTS_OF_LIMBS = {
    "arm": ("collar", "shoulder", "elbow", "wrist"),
    "leg": ("hip", "knee", "ankle", "toe"),
}


def _limbs_by_joint() -> dict[str, str]:
    """The limb, such as "left arm", of each joint that has one."""
    limbs = {}
    for side in SIDES:
        for limb, joints in _JOINTS_OF_LIMBS.items():
            for joint in joints:
                limbs[f"{side}_{joint}"] = f"{side} {limb}"
    return limbs


LIMB_OF_JOINT = _limbs_by_joint()
"""The limb, such as "left arm", of each of the twenty joints that has one."""


@dataclass(frozen=True)
class Event:
    """Findings that a user sees as one.

    Parameters
    ----------
    place : str
        The limb; of one finding its joint.
    findings : tuple of Finding
        The largest first.
    """

    place: str
    findings: tuple[Finding, ...]

    @property
    def frames(self) -> tuple[int, int]:
        """The first and the last frame."""
        firsts = [finding.frames[0] for finding in self.findings]
        lasts = [finding.frames[1] for finding in self.findings]
        return min(firsts), max(lasts)

    @property
    def largest(self) -> Finding:
        """The finding of the most centimetres."""
        return self.findings[0]

    def __repr__(self) -> str:
        first, last = self.frames
        frames = f"frames {first} to {last}" if last > first else f"frame {first}"
        moved = self.largest.movement_in_words()
        parts = [self.place, frames, moved] if moved else [self.place, frames]
        return ": ".join(parts)


def group_findings(findings: Iterable[Finding]) -> list[Event]:
    """The events of findings, the largest first; findings of the body, of the trunk and of joints
    that are none of the twenty are each an event.

    Examples
    --------
    >>> elbow = Finding("left_elbow", (28, 73), "frozen", cm=12.0)
    >>> wrist = Finding("left_wrist", (19, 83), "frozen", cm=86.9)
    >>> group_findings([elbow, wrist, Finding("head", (30, 31), "spike", cm=20.0)])
    [left arm: frames 19 to 83: 86.9 cm, head: frames 30 to 31: 20.0 cm]
    """
    groups: list[list[Finding]] = []
    latest: dict[str, list[Finding]] = {}
    ends: dict[str, int] = {}  # the last frame of the latest group of a limb
    for finding in sorted(findings, key=lambda finding: finding.frames):
        limb = LIMB_OF_JOINT.get(finding.joint, "")
        first, last = finding.frames
        if limb and first <= ends.get(limb, -1):
            latest[limb].append(finding)
            ends[limb] = max(ends[limb], last)
        else:
            latest[limb] = [finding]
            ends[limb] = last
            groups.append(latest[limb])
    events = [_make_event(group) for group in groups]
    return sorted(events, key=lambda event: _size(event.largest))


def list_events(findings: Sequence[Finding]) -> list[Event]:
    """The events of what was repaired, then those of what was not changed, by the reason."""
    events = []
    for status in STATUSES:
        events += group_findings(finding for finding in findings if finding.status == status)
    return events


def rows_of_events(events: Iterable[Event]) -> list[dict]:
    """The findings of events in their order, as the viewer lists them: objects of a file of
    findings, with the number and the place of the event."""
    rows = []
    for number, event in enumerate(events):
        for finding in event.findings:
            rows.append(finding.to_json() | {"event": number, "place": event.place})
    return rows


def _make_event(group: Sequence[Finding]) -> Event:
    by_size = tuple(sorted(group, key=_size))
    place = LIMB_OF_JOINT[group[0].joint] if len(group) > 1 else group[0].joint
    return Event(place, by_size)


def _size(finding: Finding) -> tuple[float, float]:
    """What sorts the largest first, then the most certain."""
    return -finding.cm, -finding.confidence
