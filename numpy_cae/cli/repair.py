"""Project a motion onto a learned manifold and write the result as BVH, with the rig, frame rate,
unit and length of the input file.

example: numpy-cae repair take.bvh -m model.npz -o fixed.bvh --gif fixed.gif
"""

import argparse
from functools import partial
from pathlib import Path

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.cli.output import note
from numpy_cae.manifold import SequenceManifold, repair, repair_sequence
from numpy_cae.motion import Motion


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The motion, the model and the constraints."""
    one_motion.add_file_arguments(parser)
    constrain = "keep bone lengths, standing feet and the ground (one second for five of motion)"
    parser.add_argument("--constrain", **kinds.FLAG, help=constrain)
    parser.add_argument(
        "--pin",
        type=Path,
        metavar="JSON",
        help="constrain, and move joints to the positions in this file: a list such as "
        '[{"joint": "left_wrist", "frames": [30, 45], "at": [20, 130, 35]}, {"joint": "hips", '
        '"frames": [0, 119], "path": [[0, null, 0], [50, null, 200]]}], in the unit and the '
        "frames of the motion, counted from 0; a coordinate that is null is free",
    )


def run(args: argparse.Namespace) -> int:
    """Repair the motion."""
    manifold = one_motion.load_model(args, sequential=True)
    if isinstance(manifold, SequenceManifold):
        if args.constrain or args.pin:
            raise ValueError(f"{args.model}: a sequential model supports no constraints")
        return one_motion.change(args, partial(repair_sequence, manifold=manifold))
    if not args.constrain and not args.pin:
        return one_motion.change(
            args, lambda motion, mapping: repair(motion, manifold, mapping).motion
        )
    from numpy_cae.beyond import constrain, read_pins

    def repaired(motion: Motion, mapping: dict[str, str] | None) -> Motion:
        pins = read_pins(args.pin, motion, mapping) if args.pin else []
        found = constrain(motion, repair(motion, manifold, mapping), manifold, mapping, pins)
        result = found.motion
        for pin in pins:
            errors = pin.errors(result, mapping) / motion.unit
            note(
                f"{pin.joint}, frames {pin.first} to {pin.last}: within {errors.max():.3g} of its "
                f"pin, {errors.mean():.3g} on average"
            )
        return result

    return one_motion.change(args, repaired)
