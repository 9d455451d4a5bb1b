"""Draw a motion file as a strip of poses (PNG) and as an animation (GIF), named after the file.

example: numpy-cae show walk.bvh -o pictures
"""

import argparse
from pathlib import Path

from numpy_cae.cli import arguments as kinds


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The file, the folder to write and the number of poses."""
    add = parser.add_argument
    add("file", type=Path, help="motion file (.bvh, .amc or .txt) to read")
    output = "folder to write, created if it does not exist (default: the current folder)"
    add("-o", "--output", **kinds.FOLDER, default=Path(), help=output)
    add("--poses", **kinds.COUNT, default=9, help="number of poses in the strip (default: 9)")
    kinds.add_shared(parser, "unit")


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
    strip, gif = (args.output / f"{args.file.stem}.{suffix}" for suffix in ("png", "gif"))
    save_figure(strip_figure([actor], drawn.rate, args.poses), strip)
    print(f"{strip}: {args.poses} poses")
    save_gif([actor], gif, drawn.rate)
    print(f"{gif}: the first {min(10.0, drawn.seconds):.1f} s")
    return 0
