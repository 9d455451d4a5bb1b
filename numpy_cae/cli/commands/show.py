"""Draw motion files: a strip of poses of each as a PNG file, named after the motion file; or with
--html one page that plays all motions in 3D, side by side or overlaid, in any browser.

examples, with the files that `numpy-cae demo` writes:
  numpy-cae show demo/damaged.bvh -o pictures
  numpy-cae show demo/damaged.bvh demo/repaired.bvh -o both.html
"""

import argparse
from dataclasses import replace
from itertools import cycle
from pathlib import Path

from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.output import require_one_target_each
from numpy_cae.viz.actor import CORRUPTED, PLAIN, PROJECTED, TRUTH, compared, motion_actor

COLOURS = (PROJECTED, CORRUPTED, TRUTH, PLAIN)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the folder to write and the kind of picture."""
    add = parser.add_argument
    add("files", nargs="+", **arguments.FILE, help="motion file (.bvh, .amc or .txt) to read")
    output = "folder to write, created if it does not exist (default: the current folder), or the "
    output += ".html file of the page"
    add("-o", "--output", type=Path, metavar="PATH", default=Path(), help=output)
    page = "write one interactive page with all motions instead of pictures; if a motion has the "
    page += (
        "joints and the number of frames of the first, its joints are coloured by their distance"
    )
    add("--html", **arguments.FLAG, help=page)
    arguments.add_shared(parser, "unit up floor")


def run(args: argparse.Namespace) -> int:
    """Read the files, draw them and print what was drawn."""
    from numpy_cae.mocap import load_motion
    from numpy_cae.viz import save_figure, save_viewer, strip_figure

    page, folder = None, args.output
    if args.output.suffix.lower() == ".html":
        page, folder = args.output, args.output.parent
    elif args.html:
        page = args.output / ("_".join(file.stem for file in args.files) + ".html")
    pictures = {source: folder / f"{source.stem}.png" for source in args.files}
    if page is None:
        require_one_target_each(pictures)
    motions = [load_motion(path, **vars(arguments.reading(args)[1])) for path in args.files]
    rate = motions[0].rate
    actors = []
    for source, motion in zip(args.files, motions, strict=True):
        print(f"{source}: {motion}, {motion.seconds:.1f} s, {motion.note}")
        actors.append(motion_actor(motion, source.name, rate=rate))
    folder.mkdir(parents=True, exist_ok=True)
    if page is not None:
        coloured = [
            replace(compared(actor, actors[0]), colour=colour)
            for actor, colour in zip(actors, cycle(COLOURS))
        ]
        save_viewer(coloured, page, rate)
        print(f"{page}: open it in a browser")
        return 0
    for source, actor in zip(args.files, actors, strict=True):
        save_figure(strip_figure([actor], rate), pictures[source])
        print(f"{pictures[source]}: a strip of poses")
    return 0
