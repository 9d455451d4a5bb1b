"""`numpy-cae show FILE`: a strip of poses and an animation of any motion file."""

from __future__ import annotations

import argparse
from pathlib import Path

from numpy_cae.cli import arguments as kinds


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand `show`."""
    parser = subparsers.add_parser(
        "show",
        help="draw a motion file: a strip of poses and a GIF",
        description="Draw a motion file as a strip of poses (PNG) and as an animation (GIF), "
        "named after the file.",
        epilog="example: numpy-cae show walk.bvh -o pictures",
    )
    parser.add_argument("file", type=Path, help="a .bvh, .amc or .txt file")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path(),
        metavar="FOLDER",
        help="folder to write to, created if missing; default: the current folder",
    )
    parser.add_argument(
        "--poses", type=kinds.positive_number, default=9, help="number of poses in the strip"
    )
    parser.add_argument(
        "--unit",
        type=kinds.positive,
        metavar="METRES",
        help="length of one unit of the file in metres; default: guessed or as the file says",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read the file, draw it and print what was drawn."""
    from numpy_cae.motion import load_motion
    from numpy_cae.viz import Actor, save_figure, save_gif, strip_figure

    motion = load_motion(args.file, unit=args.unit)
    print(
        f"{args.file}: {len(motion)} frames at {motion.rate:.5g} a second "
        f"({motion.seconds:.1f} s), {len(motion.skeleton.names)} joints, {motion.unit_note}"
    )
    drawn = motion.resampled(min(30.0, motion.rate))
    actor = Actor(drawn.positions(), drawn.skeleton.parents, args.file.name)
    args.output.mkdir(parents=True, exist_ok=True)
    strip = args.output / f"{args.file.stem}.png"
    save_figure(strip_figure([actor], drawn.rate, args.poses), strip)
    print(f"{strip}: {args.poses} poses")
    gif = args.output / f"{args.file.stem}.gif"
    save_gif([actor], gif, drawn.rate)
    print(f"{gif}: the first {min(10.0, drawn.seconds):.1f} s")
    return 0
