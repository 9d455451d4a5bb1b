"""Fill in the joints and frames of a motion that are missing, and leave the rest of the file
unchanged. The values that the file has in their place are ignored. In a folder every file is
filled; the exit status is 1 if some files could not be used, 2 if none could.

examples, with the files that `numpy-cae demo` writes:
  numpy-cae fill demo/true.bvh -o filled.bvh --joint left_wrist --frames 30 75
  numpy-cae fill demo/true.bvh -o smooth.bvh --keyframes 15 --html
"""

import argparse

from numpy_cae.cleanup import Repaired, fill_motion
from numpy_cae.cleanup.interpolated import missing_joints
from numpy_cae.cli.shared import arguments, change_files, damage_options, files
from numpy_cae.manifold import keyframe_mask
from numpy_cae.motion import Motion


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model and what is missing."""
    change_files.add_arguments(parser)
    group = damage_options.add_arguments(parser, "missing")
    keyframes = "keep frames 0, N, 2N, …; all joints are missing in the frames between"
    group.add_argument("--keyframes", **arguments.COUNT, help=keyframes)


def run(args: argparse.Namespace) -> int:
    """Load, fill and write each motion."""
    if damage_options.is_chosen(args) == bool(args.keyframes):
        raise ValueError("say what is missing: --joint, --limb, --frames, --mask or --keyframes")
    manifold = files.load_model(args)

    def fill(motion: Motion, progress: change_files.Progress) -> Repaired:
        findings = damage_options.chosen_findings(args, motion)
        if findings is None:
            return fill_motion(motion, manifold, keyframe_mask(len(motion), args.keyframes))
        accepted = [finding for finding in findings if finding.status == "repaired"]
        return fill_motion(motion, manifold, missing_joints(motion, accepted))

    return change_files.change_files(args, fill)
