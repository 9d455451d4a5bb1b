"""Draw motion files: a strip of poses of each as a PNG file, named after the motion file; or one
page that plays all motions in 3D, side by side or overlaid, in any browser.

examples, with the files that `numpy-cae demo` writes:
  numpy-cae show demo/damaged.bvh -o pictures
  numpy-cae show demo/damaged.bvh demo/repaired.bvh -o both.html
"""

import argparse
from pathlib import Path

from numpy_cae.atomic_write import make_folder
from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.files import require_one_target_each


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, and the folder or the page to write."""
    add = parser.add_argument
    add("files", nargs="+", **arguments.FILE, help="motion file (.bvh, .amc or .txt) to read")
    output = "folder of the pictures (default: the current one), or the .html file of a page"
    add("-o", "--output", type=Path, metavar="PATH", default=Path(), help=output)
    arguments.add_shared(parser, "overwrite unit up floor")


def run(args: argparse.Namespace) -> int:
    """Read the files, draw them and print what was drawn."""
    from numpy_cae.mocap import load_motion
    from numpy_cae.viz import save_figure, save_viewer, side_by_side, strip_figure

    is_page = args.output.suffix.lower() == ".html"
    folder = args.output.parent if is_page else args.output
    pictures = {source: folder / f"{source.stem}.png" for source in args.files}
    if not is_page:
        require_one_target_each(pictures)
    motions = [load_motion(path, **arguments.reading(args)) for path in args.files]
    for source, motion in zip(args.files, motions, strict=True):
        print(f"{source}: {motion}, {motion.seconds:.1f} s, {motion.note}")
    actors = side_by_side(motions, [source.name for source in args.files])
    make_folder(folder)
    if is_page:
        save_viewer(actors, args.output, motions[0].rate)
        print(f"{args.output}: open it in a browser")
        return 0
    for picture, actor in zip(pictures.values(), actors, strict=True):
        save_figure(strip_figure([actor], motions[0].rate), picture)
        print(f"{picture}: a strip of poses")
    return 0
