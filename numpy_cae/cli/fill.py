"""`numpy-cae fill FILE -m model.npz -o filled.bvh`: a missing joint, or poses between keyframes."""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.manifold import fill_motion_joint, fill_motion_keyframes
from numpy_cae.motion import Motion


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """File in, what is missing, model, file out."""
    parser = subparsers.add_parser(
        "fill",
        help="fill in a missing joint, or the poses between keyframes",
        description="Fill in what is missing from a motion with what a learned manifold has there, "
        "and write the result as BVH, in the rig, frame rate, unit and length of the file that "
        "came in. What was observed is left untouched: with --joint all other joints, with "
        "--keyframes every N-th frame.",
        epilog="examples: numpy-cae fill take.bvh -m model.npz -o filled.bvh --joint left_wrist; "
        "numpy-cae fill stepped.bvh -m model.npz -o smooth.bvh --keyframes 15 --gif smooth.gif",
    )
    one_motion.add_arguments(parser)
    missing = parser.add_mutually_exclusive_group(required=True)
    missing.add_argument(
        "--joint",
        metavar="NAME",
        help="the joint that is missing throughout, such as left_wrist, right_elbow, head",
    )
    missing.add_argument(
        "--keyframes",
        type=kinds.positive_number,
        metavar="N",
        help="keep every N-th frame of the file, beginning with the first",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, fill, write."""
    if args.joint is not None:
        return one_motion.change(
            args,
            lambda motion, manifold, mapping: fill_motion_joint(
                motion, manifold, args.joint, mapping
            ),
        )
    return one_motion.change(
        args,
        lambda motion, manifold, mapping: fill_motion_keyframes(
            motion, manifold, args.keyframes, mapping
        ),
        came_as=lambda motion: stepped(motion, args.keyframes),
    )


def stepped(motion: Motion, every: int) -> Motion:
    """Each keyframe held until the next."""
    held = np.arange(len(motion)) // every * every
    return replace(motion, rotations=motion.rotations[held], translations=motion.translations[held])
