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

import numpy as np

from numpy_cae.cli.shared import arguments, change_files, damage_options, one_motion
from numpy_cae.cli.shared.output import note
from numpy_cae.manifold import MotionManifold, Repaired, project_motion, repair
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


def run(args: argparse.Namespace) -> int:
    """Repair the motions."""
    manifold = one_motion.load_model(args, motion=False)
    if args.project and (damage_options.is_chosen(args) or args.smooth or args.strength < 1):
        what = "--joint, --mask, --smooth and --strength"
        raise ValueError(f"--project changes the whole motion: use it without {what}")
    return change_files.change_files(
        args, lambda motion, mapping: _repaired(args, manifold, motion, mapping)
    )


def _repaired(
    args: argparse.Namespace, manifold: MotionManifold, motion: Motion, mapping: Mappings
) -> Repaired:
    if args.project:
        return _whole(motion, project_motion(motion, manifold, mapping), mapping)
    damaged = damage_options.chosen_mask(args, motion, mapping)
    found = repair(motion, manifold, mapping, damaged, args.strength, args.smooth, args.force)
    shares = [found.touched.any(axis=axis).mean() for axis in (0, 1)]
    if damaged is None and not args.smooth and min(shares) > 0.5 and args.files[0].is_file():
        found_in = "damage was found in more than half of the joints and of the frames"
        note(f"{found_in}: if it is everywhere, --project projects the whole motion")
    return found


def _whole(motion: Motion, changed: Motion, mapping: Mappings) -> Repaired:
    """The result of a method that changes every joint in every frame."""
    moved = distances(motion, changed, mapping)
    return Repaired(changed, np.ones(moved.shape, bool), moved)
