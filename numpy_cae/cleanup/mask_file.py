"""Joints and frames that a user names as damaged or missing, and the JSON file that lists them.

A mask file is a JSON list of objects with a joint (our name or the rig's) or a limb, and frames,
first and last, counted from 0. Without a joint or limb all joints are meant, without frames all.
Objects with a kind are findings, as `write_findings` writes them.
"""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from numpy_cae.cleanup.finding import Finding, check_finding
from numpy_cae.cleanup.kinds import BODY, MARKED
from numpy_cae.mocap.formats.text_file import MotionFileError, TextFile
from numpy_cae.mocap.retargeting.to_rig import moves_alone
from numpy_cae.mocap.rigs.recognise import joint_index
from numpy_cae.motion import JOINTS, PARENTS, Motion
from numpy_cae.motion.joints import LIMBS

EXAMPLE = '[{"joint": "left_wrist", "frames": [30, 45]}, {"limb": "left_leg"}, {"frames": [5, 9]}]'

MOST_BYTES = 1 << 24
"""A longer mask file is refused."""
MOST_ENTRIES = 20_000
"""A mask file of more entries is refused. A repair takes longer with each of them; of an hour of
motion, a thousand findings are many."""


def read_mask(path: Path, motion: Motion) -> list[Finding]:
    """The findings that the entries of a mask file stand for in a motion.

    Raises MotionFileError, with the number of the entry, if the file is not as above or an entry is
    of a joint or of frames that the motion does not have.
    """
    findings = []
    for number, entry in enumerate(_read_entries(path), start=1):
        try:
            findings += entry_findings(entry, motion)
        except ValueError as error:
            raise MotionFileError(path, None, f"entry {number}: {error}") from None
    return findings


def entry_findings(entry: Any, motion: Motion) -> list[Finding]:
    """The findings that one entry stands for: that of its joint, of each joint of its limb, or of
    the whole body; ValueError if it is of something that the motion does not have."""
    if not isinstance(entry, Mapping):
        raise ValueError(f"expected one such as in {EXAMPLE}")
    if not {"joint", "limb", "frames", "kind"} & set(entry):
        raise ValueError(f"names no joint, limb or frames, expected one such as in {EXAMPLE}")
    if "kind" in entry:
        return [check_finding(motion, Finding.from_json(dict(entry)))]
    joints = []
    if "joint" in entry:
        joints.append(JOINTS[joint_index(str(entry["joint"]), motion)])
    if "limb" in entry:
        limb = str(entry["limb"])
        if limb not in LIMBS:
            raise ValueError(f"there is no limb {limb!r}, expected one of {', '.join(LIMBS)}")
        joints += LIMBS[limb]
    mark = {"frames": [0, len(motion) - 1]} | {key: entry[key] for key in entry if key != "limb"}
    marks = [mark | {"joint": joint} for joint in joints or [BODY]]
    return [check_finding(motion, Finding.from_json(mark)) for mark in marks]


def require_movable(findings: Sequence[Finding], motion: Motion) -> None:
    """Raise ValueError if all that is marked is one joint that other joints of the rig hold."""
    marked = {finding.joint for finding in findings if finding.row is MARKED}
    if len(marked) == 1 and marked < set(JOINTS) and not moves_alone(motion, *marked):
        raise ValueError(_say_what_to_name(motion, *marked))


def _say_what_to_name(motion: Motion, joint: str) -> str:
    """What to name in place of a joint that other joints hold."""
    problem = f"{joint} cannot move alone, as the joints beside it hold its place"
    for name, parent in zip(JOINTS, PARENTS, strict=True):
        if parent == JOINTS.index(joint) and moves_alone(motion, name):
            return f"{problem}: name what its rotation moves, such as {name}, or a whole limb"
    return problem


def _read_entries(path: Path) -> list[Any]:
    """The entries of a mask file."""
    content = TextFile.read(path, MOST_BYTES).data
    try:
        entries = json.loads(content, object_pairs_hook=_unique_keys)
        if not isinstance(entries, list):
            raise ValueError(f"expected a list such as {EXAMPLE}")
        if len(entries) > MOST_ENTRIES:
            raise ValueError(f"has {len(entries)} entries, expected at most {MOST_ENTRIES}")
    except (json.JSONDecodeError, RecursionError) as error:
        line = getattr(error, "lineno", None)
        raise MotionFileError(path, line, f"not JSON: {error}") from None
    except ValueError as error:
        raise MotionFileError(path, None, str(error)) from None
    return entries


def _unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object; ValueError if a key is in it twice."""
    entry = dict(pairs)
    if len(entry) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in entry if names.count(name) > 1)
        raise ValueError(f"{twice!r} is twice in one entry")
    return entry
