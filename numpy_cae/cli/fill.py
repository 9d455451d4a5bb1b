"""Fill in what is missing from a motion by a learned manifold, and write the result as BVH, with
the rig, frame rate, unit and length of the input file. Known values do not change: with --joint all
other joints, with --keyframes every N-th frame.

examples:
  numpy-cae fill take.bvh -m model.npz -o filled.bvh --joint left_wrist
  numpy-cae fill stepped.bvh -m model.npz -o smooth.bvh --keyframes 15 --gif smooth.gif
"""

import argparse
from dataclasses import replace
from functools import partial

import numpy as np

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.manifold import fill_motion, keyframe_mask
from numpy_cae.motion import JOINTS, Motion


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The motion, the model and what is missing."""
    one_motion.add_file_arguments(parser)
    add = parser.add_argument
    missing = parser.add_mutually_exclusive_group(required=True)
    missing.add_argument("--joint", metavar="NAME", help="missing joint, such as left_wrist")
    every = "number of frames from one keyframe to the next; the first frame is a keyframe"
    missing.add_argument("--keyframes", **kinds.COUNT, help=every)
    gap = "with --joint: first and last frame without the joint, from 0 (default: all frames)"
    add("--frames", type=kinds.whole_number, nargs=2, metavar=("FIRST", "LAST"), help=gap)


def run(args: argparse.Namespace) -> int:
    """Fill in the motion."""
    if args.frames and not args.joint:
        raise ValueError("--frames requires --joint")
    if args.joint not in (None, *JOINTS):
        raise ValueError(f"there is no joint {args.joint!r}, expected one of {', '.join(JOINTS)}")
    manifold = one_motion.load_model(args)

    def filled(motion: Motion, mapping: dict[str, str] | None) -> Motion:
        if args.joint is None:
            missing = keyframe_mask(len(motion), args.keyframes)
        else:
            first, last = args.frames or (0, len(motion) - 1)
            if not 0 <= first <= last < len(motion):
                raise ValueError(f"frames {first} to {last}, the motion has 0 to {len(motion) - 1}")
            missing = np.zeros((len(motion), len(JOINTS)), bool)
            missing[first : last + 1, JOINTS.index(args.joint)] = True
        return fill_motion(motion, manifold, missing, mapping).motion

    if args.joint is None:
        return one_motion.change(args, filled, partial(_held_keyframes, every=args.keyframes))
    return one_motion.change(args, filled)


def _held_keyframes(motion: Motion, every: int) -> Motion:
    """Each keyframe held until the next."""
    held = np.arange(len(motion)) // every * every
    return replace(motion, rotations=motion.rotations[held], translations=motion.translations[held])
