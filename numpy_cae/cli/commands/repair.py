"""Repair the damaged joints and frames of a motion, and leave the rest of the file unchanged. A
motion that is unlike the motions that the model learned is left unchanged. The command prints the
repaired joints, their frames, and how far they moved. In a folder every file is repaired; the exit
status is 1 if some files could not be used, 2 if none could.

examples:
  numpy-cae repair take.bvh -o fixed.bvh --html
  numpy-cae repair take.bvh -o fixed.bvh --joint left_wrist --frames 30 75
  numpy-cae repair takes/ -o repaired/
"""

import argparse

import numpy as np

from numpy_cae.cli.shared import arguments, change_files, damage_options, one_motion
from numpy_cae.manifold import MotionManifold, Repaired, project_motion, repair
from numpy_cae.manifold.repair import distances
from numpy_cae.motion import Motion


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, what is damaged and how it is repaired."""
    change_files.add_arguments(parser)
    damage_options.add_arguments(parser, "damaged", "found in the motion")
    add = parser.add_argument_group("how it is repaired").add_argument
    strength = "0 keeps the damaged positions, 1 uses the repaired ones (default: 1)"
    add("--strength", type=arguments.fraction, default=1.0, metavar="S", help=strength)
    add("--smooth", **arguments.FLAG, help="also remove jitter from the whole motion")
    add("--force", **arguments.FLAG, help="repair a motion that is unlike what the model learned")
    project = "project the whole motion onto the manifold instead, as holden2015 does"
    add("--project", **arguments.FLAG, help=project)


def run(args: argparse.Namespace) -> int:
    """Load, repair and write each motion."""
    manifold = one_motion.load_model(args)
    if args.project and (damage_options.is_chosen(args) or args.smooth or args.strength < 1):
        what = "--joint, --mask, --smooth and --strength"
        raise ValueError(f"--project changes the whole motion: use it without {what}")
    changed = change_files.ChangedFiles(args)
    for source, target in changed.files():
        with changed.reported(source):
            motion = changed.load(source)
            if args.project:
                repaired = _projected(motion, manifold)
            else:
                damaged = damage_options.chosen_mask(args, motion)
                repaired = repair(motion, manifold, damaged, args.strength, args.smooth, args.force)
            changed.write(motion, repaired, target)
    return changed.status()


def _projected(motion: Motion, manifold: MotionManifold) -> Repaired:
    """The motion on the manifold: every joint is changed in every frame."""
    projected = project_motion(motion, manifold)
    moved = distances(motion, projected)
    return Repaired(projected, np.ones(moved.shape, bool), moved)
