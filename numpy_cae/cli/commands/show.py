"""Draw motion files: a strip of poses of each as a PNG file, named after the motion file; or with
--html one page that plays all motions in 3D, side by side or overlaid, in any browser.

examples:
  numpy-cae show walk.bvh -o pictures
  numpy-cae show damaged.bvh fixed.bvh --html
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import arguments
from numpy_cae.motion import Coordinates
from numpy_cae.viz.actor import CORRUPTED, PLAIN, PROJECTED, TRUTH, Actor, motion_actor

COLOURS = (PROJECTED, CORRUPTED, TRUTH, PLAIN)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the folder to write and the kind of picture."""
    add = parser.add_argument
    add("files", nargs="+", **arguments.FILE, help="motion file (.bvh, .amc or .txt) to read")
    output = "folder to write, created if it does not exist (default: the current folder)"
    add("-o", "--output", **arguments.FOLDER, default=Path(), help=output)
    page = (
        "write one interactive page with all files instead of pictures; joints of the later files "
        "are coloured by their distance from the first file's if both have the same joints and as "
        "many frames"
    )
    add("--html", **arguments.FLAG, help=page)
    arguments.add_shared(parser, "unit up floor")


def run(args: argparse.Namespace) -> int:
    """Read the files, draw them and print what was drawn."""
    drawn = [_read(path, arguments.chosen_coordinates(args)) for path in args.files]
    args.output.mkdir(parents=True, exist_ok=True)
    if args.html:
        return _write_page(args, drawn)
    for actor, rate in drawn:
        _write_pictures(args, replace(actor, colour=PLAIN), rate)
    return 0


def _read(path: Path, coordinates: Coordinates) -> tuple[Actor, float]:
    """A file's motion, labelled with its name, and the rate at which it is drawn."""
    from numpy_cae.motion import load_motion

    motion = load_motion(path, **vars(coordinates))
    joints = len(motion.skeleton.names) - motion.skeleton.added
    print(
        f"{path}: {len(motion)} frames at {motion.rate:.5g} a second "
        f"({motion.seconds:.1f} s), {joints} joints, {motion.unit_note}"
    )
    return motion_actor(motion, path.name), min(30.0, motion.rate)


def _write_pictures(args: argparse.Namespace, actor: Actor, rate: float) -> None:
    from numpy_cae.viz import save_figure, strip_figure

    path = args.output / f"{Path(actor.label).stem}.png"
    save_figure(strip_figure([actor], rate), path)
    print(f"{path}: a strip of poses")


def _write_page(args: argparse.Namespace, drawn: list[tuple[Actor, float]]) -> int:
    from numpy_cae.viz import save_viewer

    rates = {rate for _, rate in drawn}
    if len(rates) > 1:
        listed = ", ".join(f"{actor.label} {rate:g}" for actor, rate in drawn)
        raise ValueError(f"motions of different rates cannot be compared frame by frame: {listed}")
    first = drawn[0][0]
    actors = [
        replace(_compared(actor, first), colour=COLOURS[place % len(COLOURS)])
        for place, (actor, _) in enumerate(drawn)
    ]
    path = args.output / ("_".join(file.stem for file in args.files) + ".html")
    save_viewer(actors, path, rates.pop())
    print(f"{path}: open it in a browser")
    return 0


def _compared(actor: Actor, first: Actor) -> Actor:
    """The motion with the distance of its joints from those of the first, where they agree."""
    same = actor.names == first.names and actor.positions.shape == first.positions.shape
    if actor is first or not same:
        return actor
    return replace(actor, moved=np.linalg.norm(actor.positions - first.positions, axis=-1))
