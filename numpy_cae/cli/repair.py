"""`numpy-cae repair FILE -m model.npz -o fixed.bvh`: a damaged motion, projected."""

from __future__ import annotations

import argparse
from functools import partial

from numpy_cae.cli import one_motion
from numpy_cae.manifold import repair


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """File in, model, file out."""
    parser = subparsers.add_parser(
        "repair",
        help="project a damaged motion onto a manifold",
        description="Project a motion onto a learned manifold and write the result as BVH, "
        "in the rig, frame rate, unit and length of the file that came in. Fingers and other "
        "joints beyond the twenty that the manifold knows are carried along.",
        epilog="example: numpy-cae repair take.bvh -m model.npz -o fixed.bvh --gif fixed.gif",
    )
    one_motion.add_arguments(parser)
    parser.add_argument(
        "--constrain",
        action="store_true",
        help="keep bone lengths, standing feet and the ground (takes a second for 5 of motion)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, project, write."""
    return one_motion.change(args, partial(repair, constrained=args.constrain))
