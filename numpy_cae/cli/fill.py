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
from numpy_cae.manifold import fill_joint, fill_motion_joint, fill_motion_keyframes
from numpy_cae.motion import Motion


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
    fit = "with --joint: find the motion that fits the known values, instead of one projection"
    add("--fit", **kinds.FLAG, help=fit)
    add("--data", **kinds.FOLDERS, help="with --fit: folders of motions for PCA of initial poses")


def run(args: argparse.Namespace) -> int:
    """Fill in the motion."""
    for option, required in (("frames", "joint"), ("fit", "joint"), ("data", "fit")):
        if getattr(args, option) and not getattr(args, required):
            raise ValueError(f"--{option} requires --{required}")
    manifold = one_motion.load_model(args)
    if args.joint is None:
        filled = partial(fill_motion_keyframes, manifold=manifold, every=args.keyframes)
        return one_motion.change(args, filled, partial(_held_keyframes, every=args.keyframes))
    filler = fill_joint
    if args.fit:
        from numpy_cae.beyond import fill_observed, pose_pca

        features = one_motion.load_features(args, manifold)
        filler = partial(fill_observed, poses=pose_pca(manifold, features) if features else None)
    filled = partial(fill_motion_joint, manifold=manifold, joint=args.joint, filler=filler)
    return one_motion.change(args, partial(filled, frames=args.frames))


def _held_keyframes(motion: Motion, every: int) -> Motion:
    """Each keyframe held until the next."""
    held = np.arange(len(motion)) // every * every
    return replace(motion, rotations=motion.rotations[held], translations=motion.translations[held])
