"""Fill in the joints and frames of a motion that are missing, by a learned manifold; what the file
has there is ignored, and the rest of it stays as it is, to the byte. Of a folder every file is
filled, and a table is printed; the exit status is 1 if some files could not be used, 2 if none.

examples:
  numpy-cae fill take.bvh -o filled.bvh --joint left_wrist --frames 30 75
  numpy-cae fill stepped.bvh -o smooth.bvh --keyframes 15 --gif smooth.gif
"""

import argparse

from numpy_cae.cli.shared import arguments, change_files, damage_options, one_motion
from numpy_cae.manifold import Repaired, fill_motion, keyframe_mask
from numpy_cae.motion import Mappings, Motion


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model and what is missing."""
    change_files.add_arguments(parser)
    damage_options.add_arguments(parser, "missing")
    every = "all joints are missing but in every N-th frame, from the first on"
    parser.add_argument("--keyframes", **arguments.COUNT, help=every)


def run(args: argparse.Namespace) -> int:
    """Fill in the motions."""
    if damage_options.is_chosen(args) == bool(args.keyframes):
        raise ValueError("say what is missing: --joint, --limb, --frames, --mask or --keyframes")
    manifold = one_motion.load_model(args, motion=False)

    def filled(motion: Motion, mapping: Mappings) -> Repaired:
        missing = damage_options.chosen_mask(args, motion, mapping)
        if missing is None:
            missing = keyframe_mask(len(motion), args.keyframes)
        return fill_motion(motion, manifold, missing, mapping)

    return change_files.change_files(args, filled)
