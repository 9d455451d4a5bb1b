"""Trim, split, mirror, resample or filter a motion, hold its feet or remove the flips of its
angles. Nothing else is looked for or repaired. What an edit does not change is kept as in the file.
Several edits are several commands.

examples, with the files that `numpy-cae demo` writes:
  numpy-cae edit demo/true.bvh -o trimmed.bvh --trim --frames 30 90
  numpy-cae edit demo/true.bvh -o clips --split
  numpy-cae edit demo/true.bvh -o mirrored.bvh --mirror
  numpy-cae edit demo/true.bvh -o slower.bvh --resample 15
  numpy-cae edit demo/damaged.bvh -o calm.bvh --median 2 --joint left_elbow --frames 30 60
  numpy-cae edit demo/damaged.bvh -o low_pass.bvh --low-pass 6 --fade 0.2 --frames 30 60
  numpy-cae edit demo/damaged.bvh -o even.bvh --smooth --joint left_wrist --frames 30 60
  numpy-cae edit demo/damaged.bvh -o held.bvh --feet --joint right_toe --frames 0 60
  numpy-cae edit demo/true.bvh -o turned.bvh --euler
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from numpy_cae.atomic_write import make_folder
from numpy_cae.cleanup.edits import (
    FADE_SECONDS,
    filter_jitter,
    filter_low_pass,
    filter_median,
    hold_standing_feet,
    mirror_motion,
    split_at_cuts,
    trim_motion,
)
from numpy_cae.cleanup.kinds import TOES
from numpy_cae.cli.shared import arguments
from numpy_cae.mocap import require_bvh
from numpy_cae.mocap.file_motion import KEPT_SUFFIXES, FileMotion
from numpy_cae.mocap.load import load_motion
from numpy_cae.motion import Motion
from numpy_cae.motion.motion import MAX_RATE, MIN_RATE


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The file, the edit, and which joints and frames it is for."""
    add = parser.add_argument
    add("file", **arguments.FILE, help="motion file (.bvh, .amc or .txt) to read")
    output = "file to write, in the same format or .bvh; with --split a folder for the clips"
    add("-o", "--output", type=Path, required=True, help=output)
    arguments.add_shared(parser, "overwrite mapping unit up floor")
    edits = parser.add_mutually_exclusive_group(required=True)
    edits.add_argument("--trim", **arguments.FLAG, help="keep only the frames of --frames")
    edits.add_argument("--split", **arguments.FLAG, help="write each clip of the file by itself")
    edits.add_argument("--mirror", **arguments.FLAG, help="swap the left and the right side")
    rate = "change the motion to RATE frames a second"
    edits.add_argument("--resample", type=arguments.positive, metavar="RATE", help=rate)
    euler = "remove flips and whole turns of the angles (Euler filter): the motion is the same"
    edits.add_argument("--euler", **arguments.FLAG, help=euler)
    low_pass = "filter with a Butterworth filter of this cut-off frequency"
    edits.add_argument("--low-pass", type=arguments.positive, metavar="HZ", help=low_pass)
    median = "filter with the median of N frames on each side"
    edits.add_argument("--median", **arguments.COUNT, help=median)
    smooth = "remove jitter, as `repair --smooth` does"
    edits.add_argument("--smooth", **arguments.FLAG, help=smooth)
    feet = "hold feet that stand at their places, as `repair --feet` does"
    edits.add_argument("--feet", **arguments.FLAG, help=feet)
    title = "what the filters and --feet change (default: everything)"
    group = parser.add_argument_group(title)
    joints = "joints to filter, such as left_wrist, or toes to hold, by our names or the rig's"
    group.add_argument("--joint", nargs="+", metavar="NAME", help=joints)
    frames = "first and last frame to filter or hold, or of --trim, counted from 0"
    group.add_argument(
        "--frames",
        type=arguments.whole_number,
        nargs=2,
        metavar=("FIRST", "LAST"),
        help=frames,
    )
    fade = f"seconds in which the filter begins and ends (default: {FADE_SECONDS:g})"
    group.add_argument("--fade", type=arguments.rate, metavar="SECONDS", help=fade)


def run(args: argparse.Namespace) -> int:
    """Load, edit, write and print the motion."""
    _require_suitable(args)
    motion = load_motion(args.file, **arguments.reading(args))
    if args.split:
        _write_clips(args, split_at_cuts(motion))
    else:
        _write(args, _edit(args, motion), args.output)
    return 0


def _edit(args: argparse.Namespace, motion: Motion) -> Motion:
    """The motion after the edit that the options name."""
    fade = FADE_SECONDS if args.fade is None else args.fade
    if args.trim:
        return trim_motion(motion, args.frames)
    if args.mirror:
        return mirror_motion(motion)
    if args.resample:
        return motion.resampled(args.resample)
    if args.low_pass:
        return filter_low_pass(motion, args.low_pass, args.joint, args.frames, fade)
    if args.median:
        return filter_median(motion, args.median, args.joint, args.frames, fade)
    if args.smooth:
        return filter_jitter(motion, args.joint, args.frames, fade)
    if args.feet:
        return hold_standing_feet(motion, args.joint or TOES, args.frames)
    return motion  # its angles are changed where it is written


def _write_clips(args: argparse.Namespace, clips: Sequence[Motion]) -> None:
    """Write each clip into the folder; none if one would replace the file that was read."""
    make_folder(args.output)
    suffix = args.file.suffix if args.file.suffix.lower() in KEPT_SUFFIXES else ".bvh"
    numbers = range(1, len(clips) + 1)
    paths = [args.output / f"{args.file.stem}_{number}{suffix}" for number in numbers]
    if not args.overwrite:
        for path in paths:
            arguments.require_not_read(path, [args.file])
    for clip, path in zip(clips, paths, strict=True):
        _write(args, clip, path)


def _write(args: argparse.Namespace, motion: Motion, path: Path) -> None:
    """Write a motion and print what was written; ValueError for the file that was read."""
    assert isinstance(motion, FileMotion)  # made of the motion that was loaded
    if not args.overwrite:
        arguments.require_not_read(path, [args.file])
    if args.euler:
        motion.save_with_continuous_angles(path)
    else:
        motion.save(path)
    print(f"{path}: {motion}")


def _require_suitable(args: argparse.Namespace) -> None:
    """Raise ValueError for options that the edit does not have, and for an output that cannot be
    written."""
    is_filter = args.low_pass is not None or args.median is not None or args.smooth
    if args.trim and args.frames is None:
        raise ValueError("--trim: name the frames to keep with --frames FIRST LAST")
    if args.frames is not None and not (args.trim or is_filter or args.feet):
        raise ValueError("--frames is for --trim, --low-pass, --median, --smooth and --feet")
    if args.joint is not None and not (is_filter or args.feet):
        raise ValueError("--joint is for --low-pass, --median, --smooth and --feet")
    if args.fade is not None and not is_filter:
        raise ValueError("--fade is for --low-pass, --median and --smooth")
    if args.resample is not None and not MIN_RATE <= args.resample <= MAX_RATE:
        expected = f"expected {MIN_RATE:g} to {MAX_RATE:g} frames a second"
        raise ValueError(f"--resample: the rate is {args.resample:g}, {expected}")
    if args.split:
        return
    if args.file.suffix.lower() not in KEPT_SUFFIXES or args.file.suffix != args.output.suffix:
        require_bvh(args.output)
