"""`numpy-cae repair FILE -m model.npz -o fixed.bvh`: a damaged motion, projected."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from numpy_cae.beyond import read_pins
from numpy_cae.cli import one_motion
from numpy_cae.manifold import (
    MotionManifold,
    is_sequential,
    load_sequences,
    repair,
    repair_sequence,
)
from numpy_cae.motion import Motion


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
    parser.add_argument(
        "--pin",
        type=Path,
        metavar="JSON",
        help="constrain, and bring joints where this file wants them: a list such as "
        '[{"joint": "left_wrist", "frames": [30, 45], "at": [20, 130, 35]}, {"joint": "hips", '
        '"frames": [0, 119], "path": [[0, null, 0], [50, null, 200]]}], in the unit and the '
        "frames of the motion, counted from 0; null leaves a coordinate free",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, project, write."""
    if is_sequential(args.model):
        if args.constrain or args.pin:
            raise ValueError(f"{args.model}: a sequential model knows no constraints")
        return one_motion.change(args, repair_sequence, load=load_sequences)

    def repaired(motion: Motion, manifold: MotionManifold, mapping: dict | None) -> Motion:
        pins = read_pins(args.pin, motion) if args.pin else []
        result = repair(motion, manifold, mapping, args.constrain, pins)
        for pin in pins:
            missed = pin.missed(result, mapping) / motion.unit
            print(
                f"{pin.joint}, frames {pin.first} to {pin.last}: within {missed.max():.3g} of its "
                f"pin, {missed.mean():.3g} on average",
                file=sys.stderr,
            )
        return result

    return one_motion.change(args, repaired)
