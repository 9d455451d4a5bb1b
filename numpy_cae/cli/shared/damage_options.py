"""The options --joint, --limb, --frames and --mask: which joints and frames are damaged or missing.

A mask file is a JSON list of objects with a joint (our name or the rig's) or a limb, and frames,
first and last, counted from 0. Without a joint or limb all joints are meant, without frames all.
Objects with a kind are findings, as `repair --findings` writes them.
"""

import argparse
import json
from pathlib import Path
from typing import Any

from numpy_cae.cleanup.finding import BODY, Finding, usable
from numpy_cae.cli.shared import arguments
from numpy_cae.mocap.formats.text_file import MotionFileError, TextFile
from numpy_cae.mocap.retargeting.to_rig import moves_alone
from numpy_cae.mocap.rigs.recognise import joint_index
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.joints import LIMBS

EXAMPLE = '[{"joint": "left_wrist", "frames": [30, 45]}, {"limb": "left_leg"}, {"frames": [5, 9]}]'


def add_arguments(
    parser: argparse.ArgumentParser, damaged: str, default: str = ""
) -> argparse._ArgumentGroup:
    """The options, which say which joints and frames are `damaged` ("damaged" or "missing")."""
    usual = f" (default: {default})" if default else ""
    group = parser.add_argument_group(f"which joints and frames are {damaged}{usual}")
    add = group.add_argument
    joints = f"{damaged} joints, such as left_wrist, by our names or the rig's"
    add("--joint", nargs="+", metavar="NAME", default=[], help=joints)
    limbs = f"{damaged} limbs: {', '.join(LIMBS)}"
    add("--limb", nargs="+", choices=LIMBS, metavar="LIMB", default=[], help=limbs)
    frames = "first and last frame, counted from 0, of these joints, or of all joints without "
    frames += "--joint and --limb (default: all frames)"
    add("--frames", type=arguments.whole_number, nargs=2, metavar=("FIRST", "LAST"), help=frames)
    mask = f"JSON file of joints or limbs and their frames, such as {EXAMPLE}"
    add("--mask", type=Path, metavar="JSON", help=mask)
    return group


def is_chosen(args: argparse.Namespace) -> bool:
    """Whether any of the options is given."""
    return bool(args.joint or args.limb or args.frames or args.mask)


def chosen_findings(args: argparse.Namespace, motion: Motion) -> list[Finding] | None:
    """What the options name, as findings; None without options.

    Raises UnknownRigError for an unknown joint, ValueError for frames that the motion does not
    have, MotionFileError for a mask file that is not as above.
    """
    if not is_chosen(args):
        return None
    frames = {"frames": args.frames} if args.frames else {}
    named = [{"joint": name} for name in args.joint] + [{"limb": name} for name in args.limb]
    findings = []
    for entry in named or [{}] * bool(frames):
        findings += _findings_of(entry | frames, motion)
    for number, entry in enumerate(_entries(args.mask) if args.mask else (), start=1):
        try:
            findings += _findings_of(entry, motion)
        except ValueError as error:
            raise MotionFileError(args.mask, None, f"entry {number}: {error}") from None
    marked = {finding.joint for finding in findings if finding.kind == "marked"}
    if len(marked) == 1 and marked < set(JOINTS) and not moves_alone(motion, *marked):
        raise ValueError(f"{', '.join(marked)} is fixed to other joints, of which none is named")
    return list(dict.fromkeys(findings))


def _entries(path: Path) -> list:
    """The entries of a mask file."""
    content = TextFile.read(path).data
    try:
        entries = json.loads(content, object_pairs_hook=_once_each)
        if not isinstance(entries, list):
            raise ValueError(f"expected a list such as {EXAMPLE}")
    except (ValueError, RecursionError) as error:
        is_text = isinstance(error, json.JSONDecodeError | RecursionError)
        problem = f"{'not JSON: ' * is_text}{error}"
        raise MotionFileError(path, getattr(error, "lineno", None), problem) from None
    return entries


def _once_each(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """A JSON object; ValueError if a key is in it twice."""
    entry = dict(pairs)
    if len(entry) < len(pairs):
        twice = next(key for key in entry if [name for name, _ in pairs].count(key) > 1)
        raise ValueError(f"{twice!r} is twice in one entry")
    return entry


def _findings_of(entry: Any, motion: Motion) -> list[Finding]:
    """What an entry of a mask file says: a finding for its joint, each joint of its limb, or the
    whole body."""
    if not isinstance(entry, dict):
        raise ValueError(f"expected one such as in {EXAMPLE}")
    if "kind" in entry:
        return [usable(motion, Finding.from_json(entry))]
    joints = []
    if "joint" in entry:
        joints.append(JOINTS[joint_index(str(entry["joint"]), motion)])
    if "limb" in entry:
        limb = str(entry["limb"])
        if limb not in LIMBS:
            raise ValueError(f"there is no limb {limb!r}, expected one of {', '.join(LIMBS)}")
        joints += LIMBS[limb]
    whole = {"frames": [0, len(motion) - 1]}
    others = {key: value for key, value in entry.items() if key != "limb"}
    marks = [whole | others | {"joint": joint} for joint in joints or [BODY]]
    return [usable(motion, Finding.from_json(mark)) for mark in marks]
