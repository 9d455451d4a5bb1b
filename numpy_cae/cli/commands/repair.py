"""Find what is damaged in a motion, repair that and leave the rest of the file as it is, to the
byte. A motion unlike anything that the model knows is left unchanged. Prints the joints, the frames
and how far they moved. Of a folder every file is repaired, and a table is printed; the exit status
is 1 if some files could not be used, 2 if none.

examples:
  numpy-cae repair take.bvh -o fixed.bvh --html
  numpy-cae repair take.bvh -o fixed.bvh --joint left_wrist --frames 30 75
  numpy-cae repair takes/ -o repaired/
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import arguments, change_files, damage_options, one_motion
from numpy_cae.cli.shared.output import note
from numpy_cae.manifold import Repaired, SequenceManifold, project_motion, repair, repair_sequence
from numpy_cae.manifold.model_file import Manifold
from numpy_cae.manifold.repaired import distances
from numpy_cae.motion import Mappings, Motion


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, what is damaged and how it is repaired."""
    change_files.add_arguments(parser)
    damage_options.add_arguments(parser, "damaged")
    add = parser.add_argument_group("how it is repaired").add_argument
    strength = "share of the way to the repaired positions, 0 to 1 (default: 1)"
    add("--strength", type=arguments.fraction, default=1.0, metavar="S", help=strength)
    add("--smooth", **arguments.FLAG, help="remove jitter from the whole motion too")
    add("--force", **arguments.FLAG, help="repair a motion that is unlike what the model knows")
    project = "project the whole motion onto the manifold instead, as holden2015 does"
    add("--project", **arguments.FLAG, help=project)
    add("--constrain", **arguments.FLAG, help="keep standing feet in place and above the ground")
    pins = (
        "constrain, and move joints to the positions in this file: a list such as "
        '[{"joint": "left_wrist", "frames": [30, 45], "at": [20, 130, 35]}, {"joint": "hips", '
        '"frames": [0, 119], "path": [[0, null, 0], [50, null, 200]]}], in the unit and the '
        "frames of the motion, counted from 0; a coordinate that is null is free"
    )
    add("--pin", type=Path, metavar="JSON", help=pins)


def run(args: argparse.Namespace) -> int:
    """Repair the motions."""
    manifold = one_motion.load_model(args, sequential=True, motion=False)
    whole = args.project or isinstance(manifold, SequenceManifold)
    if whole and (damage_options.is_chosen(args) or args.smooth or args.strength < 1):
        what = "--project changes" if args.project else f"{args.model}: a sequential model changes"
        raise ValueError(f"{what} the whole motion: without --joint, --mask, --smooth, --strength")
    if isinstance(manifold, SequenceManifold) and (args.constrain or args.pin):
        raise ValueError(f"{args.model}: a sequential model supports no constraints")
    return change_files.change_files(
        args, lambda motion, mapping: _repaired(args, manifold, motion, mapping)
    )


def _repaired(
    args: argparse.Namespace, manifold: Manifold, motion: Motion, mapping: Mappings
) -> Repaired:
    if isinstance(manifold, SequenceManifold):
        return _whole(motion, repair_sequence(motion, manifold, mapping), mapping)
    if args.project:
        found = _whole(motion, project_motion(motion, manifold, mapping), mapping)
    else:
        damaged = damage_options.chosen_mask(args, motion, mapping)
        found = repair(motion, manifold, mapping, damaged, args.strength, args.smooth, args.force)
        shares = [found.touched.any(axis=axis).mean() for axis in (0, 1)]
        if damaged is None and not args.smooth and min(shares) > 0.5 and args.files[0].is_file():
            found_in = "damage was found in more than half of the joints and of the frames"
            note(f"{found_in}: if it is everywhere, --project projects the whole motion")
    if not found.known or not (args.constrain or args.pin):
        return found
    from numpy_cae.beyond import constrain, read_pins

    pins = read_pins(args.pin, motion, mapping) if args.pin else []
    everywhere = found.touched
    if args.project:  # feet stand where the file has them, unless they are damaged there
        found = replace(found, touched=repair(motion, manifold, mapping, force=True).touched)
    found = constrain(motion, found, manifold, mapping, pins)
    found = replace(found, touched=found.touched | everywhere)
    for pin in pins:
        errors = pin.errors(found.motion, mapping) / motion.unit
        note(
            f"{pin.joint}, frames {pin.first} to {pin.last}: within {errors.max():.3g} of its "
            f"pin, {errors.mean():.3g} on average"
        )
    return found


def _whole(motion: Motion, changed: Motion, mapping: Mappings) -> Repaired:
    """The result of a method that changes everything; it may remove a T-pose at the beginning."""
    moved = distances(motion, changed, mapping)
    return Repaired(changed, np.ones(moved.shape, bool), moved)
