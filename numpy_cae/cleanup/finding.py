"""What was found to be damaged in a motion, and the JSON file in which findings are exchanged.

A file of findings is a JSON list with an object for each finding:

    {"joint": "left_wrist", "frames": [30, 32], "kind": "spike",
     "evidence": "rotates by 62° and back in 3 frames", "cm": 41.3, "confidence": 0.95,
     "status": "repaired", "mover": "left_wrist"}

The first object is number 1 on the page, in the terminal and for `--only`. "status" is one of
`STATUSES`: passed back, only findings that are "repaired" are mended, and those with "accept":
true. A user may remove objects, change their joints and frames, and add others; `joint` and
`frames` are enough.
"""

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cleanup.kinds import BODY, FOOT, KINDS, MARKED, T_POSE, Kind
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.masks import runs
from numpy_cae.visible import visible

LEFT_REASON = "feet would slide more or joints would jump or shake more"
"""Why a finding was not mended although it is certain."""
KEPT_REASON = "nothing is wrong there"
"""Why a finding changes nothing although it is certain."""
STATUSES = ("repaired", "proposed", "left", "kept")
"""What became of a finding: it was mended; it is not certain enough and was not mended; it was not
mended since mending made the motion worse (`LEFT_REASON`); it is right, such as a T-pose at the
start, or mending it moved no joint, so that the motion stayed as it was (`KEPT_REASON`)."""


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
        One of the names in `kinds.KINDS`.
    evidence : str
        What in the file shows the damage, with numbers.
    cm : float
        How far the repair moves the joint, or a joint that follows it, at most, in centimetres;
        0 where nothing was moved, and then it is not printed.
    confidence : float
        0 to 1. The repair changes what has at least 1 - `sensitivity`; the rest is proposed.
    status : str
        One of `STATUSES`.
    mover : str
        The joint that `cm` is about; "" where nothing was moved.

    Raises
    ------
    ValueError
        If the frames are not in order, or the kind, the confidence or the status is not one of
        these.

    Examples
    --------
    >>> spike = Finding("left_wrist", (30, 32), "spike", "rotates by 62° and back", 41.3, 0.95)
    >>> spike
    left_wrist: frames 30 to 32: spike (rotates by 62° and back): 41.3 cm, confidence 0.95
    >>> Finding.from_json(spike.to_json()) == spike
    True
    """

    joint: str
    frames: tuple[int, int]
    kind: str = MARKED.name
    evidence: str = ""
    cm: float = 0.0
    confidence: float = 1.0
    status: str = "repaired"
    mover: str = ""

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
        reasons = []
        if self.evidence:
            reasons.append(self.evidence)
        if self.status == "left":
            reasons.append(f"left alone, since {LEFT_REASON}")
        reason = f" ({'; '.join(reasons)})" if reasons else ""
        moved = self.movement_in_words()
        separator = ", " if moved else ""
        certainty = f"{moved}{separator}confidence {self.confidence:.2f}"
        return f"{self.place}: {self.kind}{reason}: {certainty}"

    @property
    def place(self) -> str:
        """The joint and the frames in words, such as "left_knee: frames 40 to 90"."""
        first, last = self.frames
        frames = f"frames {first} to {last}" if last > first else f"frame {first}"
        return f"{self.joint}: {frames}"

    def movement_in_words(self) -> str:
        """How far the repair moves which joint, such as "left_wrist 86.9 cm": without the name
        where the joint is that of the finding; "" where nothing was moved."""
        if not self.cm:
            return ""
        name = "" if self.mover in ("", self.joint) else f"{self.mover} "
        return f"{name}{self.cm:.1f} cm"

    @property
    def row(self) -> Kind:
        """What holds for findings of this kind: the row of `KINDS`."""
        return KINDS[self.kind]

    @property
    def is_repaired(self) -> bool:
        """Whether the finding is, or is to be, mended."""
        return self.status == "repaired"

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
        defaults = {"kind": MARKED.name, "evidence": "", "cm": 0.0, "confidence": 1.0}
        match defaults | {"status": "repaired", "mover": "", "accept": False} | entry:
            case {
                "joint": str(),
                "frames": [int() as first, int() as last],
                "kind": str(),
                "evidence": str() as evidence,
                "cm": int() | float(),
                "confidence": int() | float(),
                "status": str() as status,
                "mover": str(),
                "accept": bool() as accept,
                **unexpected,
            } if not unexpected:
                values = {key: value for key, value in entry.items() if key != "accept"}
                values["frames"] = (first, last)
                values["status"] = "repaired" if accept else status
                values["evidence"] = visible(evidence)  # halves of characters cannot be written
                return Finding(**values)
        raise ValueError(f"expected an object such as {json.dumps(EXAMPLE_FINDING.to_json())}")


def is_path(finding: Finding) -> bool:
    """Whether a finding says that the path of the root follows from the feet."""
    return finding.joint == BODY and finding.row is FOOT


def confidence(score: float) -> float:
    """The confidence of a finding whose evidence is `score` times its threshold: 1 - 1 / (2 score),
    which is 0.5 at the threshold."""
    return 1 - 0.5 / max(float(score), 0.5)


EXAMPLE_FINDING = Finding("left_wrist", (30, 32), "spike", "rotates by 62° and back", 41.3, 0.95)


def findings_of_mask(
    mask: np.ndarray, names: Sequence[str] = JOINTS, kind: Kind = MARKED
) -> list[Finding]:
    """The runs of a mask (frames, joints) as findings of a kind."""
    findings = []
    for name, column in zip(names, mask.T, strict=True):
        for first, end in runs(column):
            findings.append(Finding(name, (int(first), int(end) - 1), kind.name))
    return findings


def joint_names(motion: Motion) -> list[str]:
    """Our name of each joint of a rig that is one of the twenty, else the rig's."""
    names = list(motion.skeleton.names)
    for name, joint in zip(JOINTS, rig_of(motion).joints, strict=True):
        names[joint] = name
    return names


def check_finding(motion: Motion, finding: Finding) -> Finding:
    """A finding of a user with our name of its joint; ValueError if it cannot be mended in the
    motion."""
    joint = finding.joint
    last = len(motion) - 1
    names = joint_names(motion)
    if joint not in JOINTS and joint in motion.skeleton.names:
        joint = names[motion.skeleton.index(joint)]
    elif joint not in (BODY, *names):
        raise ValueError(f"{finding.place}: the rig has no joint {joint!r}")
    row = finding.row
    if row.joints and joint not in row.joints:
        is_short = len(row.joints) < len(JOINTS)
        expected = ", ".join(row.joints) if is_short else "one of the twenty joints"
        raise ValueError(f"{finding.place}: of kind {finding.kind!r} the joint is {expected}")
    if joint == BODY and row.is_of_one_joint:
        raise ValueError(f"{finding.place}: of kind {finding.kind!r} name the joint")
    if finding.frames[1] > last:
        raise ValueError(f"{finding.place}: the motion has frames 0 to {last}")
    if row is T_POSE and (finding.frames[0] or finding.frames[1] == last):
        raise ValueError(
            f"{finding.place}: a T-pose is at the start and ends before the last frame"
        )
    if (row.is_of_one_joint or (row is MARKED and joint == BODY)) and finding.frames == (0, last):
        raise ValueError(f"{finding.place}: no frame is left that says what is right")
    return replace(finding, joint=joint)


def shift_findings(findings: Sequence[Finding], frames: int) -> list[Finding]:
    """The findings some frames later; what lies before frame 0 is left out."""
    shifted = []
    for finding in findings:
        first, last = finding.frames
        if last + frames >= 0:
            shifted.append(replace(finding, frames=(max(first + frames, 0), last + frames)))
    return shifted


def findings_within(findings: Sequence[Finding], first: int, end: int) -> list[Finding]:
    """The findings in the frames from `first` to before `end`, counted from `first`."""
    within = []
    for finding in shift_findings(findings, -first):
        start, last = finding.frames
        if start < end - first:
            within.append(replace(finding, frames=(start, min(last, end - first - 1))))
    return within


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
    >>> write_findings("findings.json", [Finding("left_wrist", (30, 32), "spike")])
    >>> json.loads(Path("findings.json").read_text("utf-8"))[0]["frames"]
    [30, 32]
    """
    lines = [json.dumps(finding.to_json(), ensure_ascii=False) for finding in findings]
    with atomic_write(path) as temporary:
        temporary.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")
