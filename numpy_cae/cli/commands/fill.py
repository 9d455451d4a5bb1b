"""Fill in the joints and frames of a motion that are missing, and leave the rest of the file
unchanged. The values that the file has in their place are ignored. In a folder every file is
filled; the exit status is 1 if some files could not be used, 2 if none could.

examples, with the files that `numpy-cae demo` writes:
  numpy-cae fill demo/true.bvh -o filled.bvh --joint left_wrist --frames 30 75
  numpy-cae fill demo/true.bvh -o smooth.bvh --keyframes 15 --html
"""

import argparse

import numpy as np

from numpy_cae.cleanup import fill_motion
from numpy_cae.cleanup.interpolation import mark_missing_joints
from numpy_cae.cli.shared import arguments, change_files, damage_options, files
from numpy_cae.cli.shared.output import working
from numpy_cae.cli.shared.summary import summary_of_filling
from numpy_cae.manifold import keyframe_mask
from numpy_cae.mocap.load import load_motion
from numpy_cae.motion import Motion

READING_SHARE = 0.08
"""The share of the time that reading takes."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the model and what is missing."""
    change_files.add_arguments(parser)
    group = damage_options.add_arguments(parser, "missing")
    keyframes = "keep frames 0, N, 2N, …; all joints are missing in the frames between"
    group.add_argument("--keyframes", **arguments.COUNT, help=keyframes)


def run(args: argparse.Namespace) -> int:
    """Load, fill, write and print each motion."""
    if damage_options.is_chosen(args) == bool(args.keyframes):
        raise ValueError("say what is missing: --joint, --limb, --frames, --mask or --keyframes")
    if (args.joint or args.limb) and not args.frames:
        names = ", ".join([*args.joint, *args.limb])
        print(f"replaced in all frames, since --frames is not given: {names}")
    manifold = files.load_model(args)
    outcome = change_files.Outcome(args)
    reading = arguments.reading(args)
    with working(outcome.title) as is_done:
        for number, source in enumerate(outcome.targets):
            progress = outcome.progress_of(number, READING_SHARE, 1 - READING_SHARE, is_done)
            with outcome.of_file(source):
                motion = load_motion(source, **reading)
                progress(0.0)
                filled = fill_motion(motion, manifold, _missing(args, motion))
                summary = summary_of_filling(source, motion, filled)
                # The motion last: where its page may not be replaced, nothing is written.
                page, row = change_files.write_page(outcome, source, motion, filled, summary)
                written = change_files.write_motion(outcome, source, motion, filled)
                written |= page
                change_files.print_summary(outcome, source, motion, filled, summary, written)
                outcome.rows.append(row)
    return outcome.end()


def _missing(args: argparse.Namespace, motion: Motion) -> np.ndarray:
    """What the options say is missing, (frames, 20) of bool."""
    findings = damage_options.chosen_findings(args, motion)
    if findings is None:
        return keyframe_mask(len(motion), args.keyframes)
    return mark_missing_joints(motion, [finding for finding in findings if finding.is_repaired])
