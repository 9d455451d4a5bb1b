"""`numpy-cae fill FILE -m model.npz -o filled.bvh`: a missing joint, or poses between keyframes."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from numpy_cae.baselines import PCA
from numpy_cae.beyond import poses_of
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.manifold import MotionManifold, fill_motion_joint, fill_motion_keyframes
from numpy_cae.motion import Motion, find_motion_files, load_body


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
    parser.add_argument(
        "--frames",
        type=kinds.whole_number,
        nargs=2,
        metavar=("FIRST", "LAST"),
        help="with --joint: it is missing in these frames alone, counted from 0",
    )
    parser.add_argument(
        "--fit",
        action="store_true",
        help="with --joint: find the motion that fits what was observed, instead of one projection "
        "with the mean pose for what was not, as in the paper (takes a second for 5 of motion)",
    )
    parser.add_argument(
        "--data",
        type=Path,
        nargs="+",
        metavar="FOLDER",
        default=[],
        help="with --fit: start from what PCA of these motions makes of the other joints",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, fill, write."""
    if args.joint is None and (args.frames or args.fit):
        raise ValueError(f"{'--frames' if args.frames else '--fit'} is for --joint")
    if args.data and not args.fit:
        raise ValueError("--data is for --fit")
    if args.joint is not None:
        return one_motion.change(
            args,
            lambda motion, manifold, mapping: fill_motion_joint(
                motion,
                manifold,
                args.joint,
                mapping,
                args.frames and tuple(args.frames),
                args.fit,
                _poses(args, manifold, mapping),
            ),
        )
    return one_motion.change(
        args,
        lambda motion, manifold, mapping: fill_motion_keyframes(
            motion, manifold, args.keyframes, mapping
        ),
        came_as=lambda motion: stepped(motion, args.keyframes),
    )


def _poses(
    args: argparse.Namespace, manifold: MotionManifold, mapping: dict[str, str] | None
) -> PCA | None:
    if not args.data:
        return None
    files = [path for folder in args.data for path in find_motion_files(folder)]
    return poses_of(manifold, [manifold.features(load_body(path, mapping)[0])[0] for path in files])


def stepped(motion: Motion, every: int) -> Motion:
    """Each keyframe held until the next."""
    held = np.arange(len(motion)) // every * every
    return replace(motion, rotations=motion.rotations[held], translations=motion.translations[held])
