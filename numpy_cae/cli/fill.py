"""`numpy-cae fill FILE -m model.npz -o filled.bvh`: fill in a joint, or poses between keyframes."""

from __future__ import annotations

import argparse
from dataclasses import replace
from functools import partial

import numpy as np

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.manifold import MotionManifold, fill_joint, fill_motion_joint, fill_motion_keyframes
from numpy_cae.manifold.fill import JointFiller
from numpy_cae.motion import Motion


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand and its arguments."""
    parser = subparsers.add_parser(
        "fill",
        help="fill in a missing joint, or the frames between keyframes",
        description="Fill in what is missing from a motion by a learned manifold, and write the "
        "result as BVH, with the rig, frame rate, unit and length of the input file. Known values "
        "do not change: with --joint all other joints, with --keyframes every N-th frame.",
        epilog="examples: numpy-cae fill take.bvh -m model.npz -o filled.bvh --joint left_wrist; "
        "numpy-cae fill stepped.bvh -m model.npz -o smooth.bvh --keyframes 15 --gif smooth.gif",
    )
    one_motion.add_file_arguments(parser)
    missing = parser.add_mutually_exclusive_group(required=True)
    missing.add_argument(
        "--joint", metavar="NAME", help="name of the missing joint: left_wrist, right_elbow, head…"
    )
    missing.add_argument(
        "--keyframes",
        type=kinds.positive_number,
        metavar="N",
        help="number of frames from one keyframe to the next; the first frame is a keyframe",
    )
    parser.add_argument(
        "--frames",
        type=kinds.whole_number,
        nargs=2,
        metavar=("FIRST", "LAST"),
        help="with --joint: first and last frame in which it is missing, counted from 0 (default: "
        "all)",
    )
    parser.add_argument(
        "--fit",
        action="store_true",
        help="with --joint: find the motion that fits the known values, instead of one projection "
        "as in the paper (takes one second for five seconds of motion)",
    )
    one_motion.add_data_argument(
        parser, "with --fit: folders of motions for the PCA that estimates the initial poses"
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Fill in the motion."""
    if args.joint is None and (args.frames or args.fit):
        raise ValueError(f"{'--frames' if args.frames else '--fit'} requires --joint")
    if args.data and not args.fit:
        raise ValueError("--data requires --fit")
    model = one_motion.load_model(args)
    manifold = one_motion.require_convolutional(model, args.model, "fill")
    if args.joint is None:
        return one_motion.change(
            args,
            manifold,
            lambda motion, mapping: fill_motion_keyframes(
                motion, manifold, args.keyframes, mapping
            ),
            before=lambda motion: _held_keyframes(motion, args.keyframes),
        )
    frames = tuple(args.frames) if args.frames else None
    filler = _filler(args, manifold)
    return one_motion.change(
        args,
        manifold,
        lambda motion, mapping: fill_motion_joint(
            motion, manifold, args.joint, mapping, frames, filler
        ),
    )


def _filler(args: argparse.Namespace, manifold: MotionManifold) -> JointFiller:
    if not args.fit:
        return fill_joint
    from numpy_cae.beyond import fill_observed, pose_pca

    features = one_motion.load_features(args, manifold)
    return partial(fill_observed, poses=pose_pca(manifold, features) if features else None)


def _held_keyframes(motion: Motion, every: int) -> Motion:
    """Each keyframe held until the next."""
    held = np.arange(len(motion)) // every * every
    return replace(motion, rotations=motion.rotations[held], translations=motion.translations[held])
