"""The options --joint, --limb, --frames and --mask: what is damaged or missing."""

import argparse
from pathlib import Path

from numpy_cae.cleanup.finding import Finding
from numpy_cae.cleanup.mask_file import EXAMPLE, entry_findings, read_mask, require_movable
from numpy_cae.cli.shared import arguments
from numpy_cae.mocap.formats.text_file import MotionFileError
from numpy_cae.motion import Motion
from numpy_cae.motion.joints import LIMBS


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
    frames = "first and last frame, counted from 0, in which these joints are "
    frames += f"{damaged}; without --joint and --limb all joints are (default: all frames)"
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
    if frames and not named:
        named = [{}]
    findings = []
    for entry in named:
        findings += entry_findings(entry | frames, motion)
    if args.mask:
        findings += read_mask(args.mask, motion)
    try:
        require_movable(findings, motion)
    except ValueError as error:
        if args.mask:
            raise MotionFileError(args.mask, None, str(error)) from None
        raise
    return list(dict.fromkeys(findings))
