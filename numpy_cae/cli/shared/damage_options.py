"""The options --joint, --limb and --frames: which joints and frames are damaged or missing."""

import argparse

import numpy as np

from numpy_cae.cli.shared import arguments
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.joints import LIMBS, joint_mask
from numpy_cae.motion.retarget.rigs import joint_index
from numpy_cae.motion.retarget.to_rig import moves_alone


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
    return group


def is_chosen(args: argparse.Namespace) -> bool:
    """Whether any of the options is given."""
    return bool(args.joint or args.limb or args.frames)


def chosen_mask(args: argparse.Namespace, motion: Motion) -> np.ndarray | None:
    """The joints and frames of a motion that the options name, (frames, 20) bool; None without
    options.

    Raises UnknownRigError for an unknown joint, ValueError for frames that the motion does not
    have.
    """
    if not is_chosen(args):
        return None
    chosen = [JOINTS[joint_index(name, motion.skeleton)] for name in args.joint]
    if len(chosen) == 1 and not args.limb and not moves_alone(motion, chosen[0]):
        raise ValueError(f"{chosen[0]} is fixed to other joints, of which none is named")
    for limb in args.limb:
        chosen += LIMBS[limb]
    first, last = args.frames or (0, len(motion) - 1)
    if not first <= last < len(motion):
        after = "the first is after the last and " if first > last else ""
        raise ValueError(f"frames {first} to {last}, {after}the motion has 0 to {len(motion) - 1}")
    return joint_mask(len(motion), chosen or JOINTS, slice(first, last + 1))
