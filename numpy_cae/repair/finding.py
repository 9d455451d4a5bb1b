"""What was found to be damaged in a motion, and the JSON file in which findings are exchanged.

A file of findings is a JSON list with an object for each finding:

    {"joint": "left_wrist", "frames": [30, 32], "kind": "spike",
     "evidence": "rotates by 62° and back in 3 frames", "cm": 41.3, "confidence": 0.95}

A user may remove objects, change their joints and frames, and add others; `joint` and `frames` are
enough.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from numpy_cae.atomic_write import atomic_write

KINDS = (
    *("T-pose", "root elsewhere", "turned", "displaced", "spike", "length", "repeated", "frozen"),
    *("not finite", "jumps", "jitter", "foot", "unlikely", "marked"),
)
"""Kinds of findings:

- T-pose: a pose of reference at the start, which a jump ends
- root elsewhere: the body is at another place for some frames, or from a frame on
- turned: a rotation is turned, by the same turn, for some frames or from a frame on
- displaced: a rotation is another between a jump and the jump back
- spike: a rotation jumps away and back within a few frames
- length: a bone has another length than in the rest of the file
- repeated: the file repeats a pose until the motion jumps on
- frozen: a rotation stands still until it jumps
- not finite: values are no numbers
- jumps: a joint jumps from frame to frame
- jitter: noise in every frame
- foot: a foot that stands slides, or is in the floor or above it; of the body, the root does not
  move as the feet do
- unlikely: the manifold has another pose there
- marked: the user says so
"""
BODY = "body"
"""BODY: the `joint` of a finding about the whole body."""


@dataclass(frozen=True)
class Finding:
    """Damage of one joint, or of the whole body, in a stretch of frames.

    Parameters
    ----------
    joint : str
        One of the twenty joints, "body" for all of them, or another joint by the rig's name.
    frames : (int, int)
        The first and the last frame of the file, counted from 0.
    kind : str
        One of `KINDS`.
    evidence : str
        What in the file shows the damage, with numbers.
    cm : float
        How far the repair moves the joint, or a joint that follows it, at most, in centimetres;
        0 where nothing was moved, and then it is not printed.
    confidence : float
        0 to 1. The repair changes what has at least 1 - `sensitivity`; the rest is proposed.

    Raises
    ------
    ValueError
        If the frames are not in order, or the kind or the confidence is not one of these.

    Examples
    --------
    >>> found = Finding("left_wrist", (30, 32), "spike", "rotates by 62° and back", 41.3, 0.95)
    >>> found
    left_wrist: frames 30 to 32: spike (rotates by 62° and back): 41.3 cm, confidence 0.95
    >>> Finding.from_json(found.to_json()) == found
    True
    """

    joint: str
    frames: tuple[int, int]
    kind: str = "marked"
    evidence: str = ""
    cm: float = 0.0
    confidence: float = 1.0

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"kind is {self.kind!r}, expected one of {', '.join(KINDS)}")
        if not 0 <= self.frames[0] <= self.frames[1]:
            raise ValueError(f"frames are {list(self.frames)}, expected the first and the last")
        if not 0 <= self.confidence <= 1:
            raise ValueError(f"confidence is {self.confidence}, expected 0 to 1")

    def __repr__(self) -> str:
        first, last = self.frames
        frames = f"frames {first} to {last}" if last > first else f"frame {first}"
        why = f" ({self.evidence})" if self.evidence else ""
        moved = f"{self.cm:.1f} cm, " if self.cm else ""
        return f"{self.joint}: {frames}: {self.kind}{why}: {moved}confidence {self.confidence:.2f}"

    @property
    def stretch(self) -> slice:
        """The frames."""
        return slice(self.frames[0], self.frames[1] + 1)

    def to_json(self) -> dict:
        """The finding as an object of a file of findings."""
        rounded = {"cm": round(self.cm, 2), "confidence": round(self.confidence, 2)}
        return asdict(self) | {"frames": list(self.frames)} | rounded

    @staticmethod
    def from_json(entry: dict) -> Finding:
        """The finding that an object of a file of findings describes.

        Raises ValueError if `joint` or `frames` is missing, or a value has another type.
        """
        match {"kind": "marked", "evidence": "", "cm": 0.0, "confidence": 1.0} | entry:
            case {
                "joint": str(),
                "frames": [int() as first, int() as last],
                "kind": str(),
                "evidence": str(),
                "cm": int() | float(),
                "confidence": int() | float(),
                **others,
            } if not others:
                return Finding(**entry | {"frames": (first, last)})
        raise ValueError(f"expected an object such as {json.dumps(EXAMPLE.to_json())}")


EXAMPLE = Finding("left_wrist", (30, 32), "spike", "rotates by 62° and back", 41.3, 0.95)


def write_findings(path: str | Path, findings: Iterable[Finding]) -> None:
    """Write findings to a JSON file, one on each line, atomically.

    Parameters
    ----------
    path : path of the file
    findings : iterable of Finding

    Raises
    ------
    FileError
        If the file cannot be written.

    Examples
    --------
    >>> write_findings("found.json", [Finding("left_wrist", (30, 32), "spike")])
    >>> json.loads(Path("found.json").read_text("utf-8"))[0]["frames"]
    [30, 32]
    """
    lines = [json.dumps(finding.to_json(), ensure_ascii=False) for finding in findings]
    with atomic_write(path) as temporary:
        temporary.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")
