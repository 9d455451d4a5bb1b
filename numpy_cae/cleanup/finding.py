"""What was found to be damaged in a motion, and the JSON file in which findings are exchanged.

A file of findings is a JSON list with an object for each finding:

    {"joint": "left_wrist", "frames": [30, 32], "kind": "spike",
     "evidence": "rotates by 62° and back in 3 frames", "cm": 41.3, "confidence": 0.95,
     "status": "repaired"}

"status" is one of `STATUSES`: passed back, only findings that are "repaired" are mended, and those
with "accept": true. A user may remove objects, change their joints and frames, and add others;
`joint` and `frames` are enough.
"""

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.masks import runs

KINDS = (
    *("T-pose", "root elsewhere", "turned", "limb turned", "displaced", "spike", "length"),
    *("repeated", "frozen", "not finite", "jumps", "jitter", "foot", "marked"),
)
"""Kinds of findings:

- T-pose: a pose of reference at the start, which a jump ends
- root elsewhere: the body is at another place for some frames, or from a frame on
- turned: a rotation is turned, by the same turn, for some frames or from a frame on
- limb turned: a hip is turned, by a turn that begins and ends within a few frames
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
- marked: the user says so
"""
BODY = "body"
"""BODY: the `joint` of a finding about the whole body."""
OF_ONE_JOINT = ("turned", "displaced", "length", "root elsewhere")
"""OF_ONE_JOINT: findings of these kinds are about one joint, in some of the frames."""
JOINTS_OF_KIND = {
    **dict.fromkeys(("T-pose", "jitter", "repeated"), (BODY,)),
    **dict.fromkeys(("jumps", "marked"), (BODY, *JOINTS)),
    "foot": (BODY, "left_toe", "right_toe"),
    "limb turned": ("left_hip", "right_hip"),
}
"""JOINTS_OF_KIND: findings of these kinds are about one of these; others may be about any joint of
the rig."""
STATUSES = dict.fromkeys(("repaired", "proposed"), "") | {
    "left": "left alone, since feet would slide more or joints would jump more"
}
"""STATUSES: what became of a finding, and what is printed about it: it was mended; it is not
certain enough and was not mended; it was not mended since mending made the motion worse."""


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
    status : str
        One of `STATUSES`.

    Raises
    ------
    ValueError
        If the frames are not in order, or the kind, the confidence or the status is not one of
        these.

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
    status: str = "repaired"

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise ValueError(f"kind is {self.kind!r}, expected one of {', '.join(KINDS)}")
        if not 0 <= self.frames[0] <= self.frames[1]:
            raise ValueError(f"frames are {list(self.frames)}, expected the first and the last")
        if not 0 <= self.confidence <= 1:
            raise ValueError(f"confidence is {self.confidence}, expected 0 to 1")
        if self.status not in STATUSES:
            raise ValueError(f"status is {self.status!r}, expected one of {', '.join(STATUSES)}")

    def __repr__(self) -> str:
        first, last = self.frames
        frames = f"frames {first} to {last}" if last > first else f"frame {first}"
        why = "; ".join(filter(None, [self.evidence, STATUSES[self.status]]))
        why = f" ({why})" if why else ""
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
    def from_json(entry: dict) -> "Finding":
        """The finding that an object of a file of findings describes; with "accept": true, one that
        is to be repaired whatever its status.

        Raises ValueError if `joint` or `frames` is missing, or a value has another type.
        """
        usual = {"kind": "marked", "evidence": "", "cm": 0.0, "confidence": 1.0}
        match usual | {"status": "repaired", "accept": False} | entry:
            case {
                "joint": str(),
                "frames": [int() as first, int() as last],
                "kind": str(),
                "evidence": str(),
                "cm": int() | float(),
                "confidence": int() | float(),
                "status": str() as status,
                "accept": bool() as accept,
                **others,
            } if not others:
                given = {"frames": (first, last), "status": "repaired" if accept else status}
                return Finding(**{key: entry[key] for key in entry if key != "accept"} | given)
        raise ValueError(f"expected an object such as {json.dumps(EXAMPLE.to_json())}")


def is_path(finding: Finding) -> bool:
    """Whether a finding says that the path of the root follows from the feet."""
    return (finding.joint, finding.kind) == (BODY, "foot")


def confidence(score: float) -> float:
    """The confidence of a finding whose evidence is `score` times its threshold: 1 - 1 / (2 score),
    which is 0.5 at the threshold."""
    return 1 - 0.5 / max(float(score), 0.5)


EXAMPLE = Finding("left_wrist", (30, 32), "spike", "rotates by 62° and back", 41.3, 0.95)


def marked(mask: np.ndarray, names: Sequence[str] = JOINTS, kind: str = "marked") -> list[Finding]:
    """The runs of a mask (frames, joints) as findings of a kind."""
    return [
        Finding(name, (int(first), int(end) - 1), kind)
        for name, column in zip(names, mask.T, strict=True)
        for first, end in runs(column)
    ]


def joint_names(motion: Motion) -> list[str]:
    """Our name of each joint of a rig that is one of the twenty, else the rig's."""
    names = list(motion.skeleton.names)
    for name, joint in zip(JOINTS, rig_of(motion).joints, strict=True):
        names[joint] = name
    return names


def usable(motion: Motion, finding: Finding) -> Finding:
    """A finding of a user with our name of its joint; ValueError if it cannot be mended in the
    motion."""
    joint = finding.joint
    last = len(motion) - 1
    names = joint_names(motion)
    if joint not in JOINTS and joint in motion.skeleton.names:
        joint = names[motion.skeleton.index(joint)]
    elif joint not in (BODY, *names):
        raise ValueError(f"{finding}: the rig has no joint {joint!r}")
    allowed = JOINTS_OF_KIND.get(finding.kind)
    if allowed and joint not in allowed:
        expected = ", ".join(allowed) if len(allowed) < len(JOINTS) else "one of the twenty joints"
        raise ValueError(f"{finding}: of kind {finding.kind!r} the joint is {expected}")
    if joint == BODY and finding.kind in OF_ONE_JOINT:
        raise ValueError(f"{finding}: of kind {finding.kind!r} name the joint")
    if finding.frames[1] > last:
        raise ValueError(f"{finding}: the motion has frames 0 to {last}")
    if finding.kind == "T-pose" and (finding.frames[0] or finding.frames[1] == last):
        raise ValueError(f"{finding}: a T-pose is at the start and ends before the last frame")
    if finding.kind in OF_ONE_JOINT and finding.frames == (0, last):
        raise ValueError(f"{finding}: no frame is left that says what is right")
    return replace(finding, joint=joint)


def shifted(findings: Sequence[Finding], frames: int) -> list[Finding]:
    """The findings some frames later; what lies before frame 0 is left out."""
    return [
        replace(finding, frames=(max(finding.frames[0] + frames, 0), finding.frames[1] + frames))
        for finding in findings
        if finding.frames[1] + frames >= 0
    ]


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
