"""`numpy-cae repair FILE -m model.npz -o fixed.bvh`: a damaged motion, projected."""

from __future__ import annotations

import argparse

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
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, project, write."""
    return one_motion.change(args, repair)
