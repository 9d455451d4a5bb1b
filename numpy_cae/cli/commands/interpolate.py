"""Interpolate between two motions along a learned manifold. The result has the rig, the frame rate
and the unit of the first motion; the longer motion is truncated.

example, with the files that `numpy-cae demo` writes:
  numpy-cae interpolate demo/damaged.bvh demo/true.bvh -o between.bvh --share transition --html
"""

import argparse
from pathlib import Path

from numpy_cae.cli.shared import arguments, files
from numpy_cae.cli.shared.output import note
from numpy_cae.manifold.interpolation import TRANSITION, interpolate, shares, with_path
from numpy_cae.mocap import Body, load_body, require_bvh
from numpy_cae.viz import OTHERS, PROJECTED, TRUTH
from numpy_cae.viz.actor import world_actors


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The two motions, the model and the share of the second."""
    add = parser.add_argument
    add("first", type=Path, help="first motion file (.bvh or .amc)")
    add("second", type=Path, help="second motion file, of any rig")
    files.add_output_arguments(parser)
    files.add_model_arguments(parser)
    add(
        "--share",
        type=lambda text: text if text == TRANSITION else arguments.fraction(text),
        default=0.5,
        metavar="S",
        help="weight of the second motion, 0 to 1 (default: 0.5), or `transition` from 0 to 1",
    )


def run(args: argparse.Namespace) -> int:
    """Interpolate the hidden units of the two motions."""
    require_bvh(args.output)
    manifold = files.load_model(args)
    reading = arguments.reading(args)
    motions = [load_body(path, **reading)[1] for path in (args.first, args.second)]
    first, second = (Body(motion, manifold.lengths) for motion in motions)
    sources = first.features, second.features
    between = with_path(interpolate(manifold, *sources, args.share), *sources, args.share)
    frames = len(between)
    note(f"{len(first.features)} and {len(second.features)} frames at 30 a second, {frames} used")
    files.write(first.to_rig(between), args.output)
    if args.html:
        share = "transition" if args.share == TRANSITION else f"{args.share:.0%} of the second"
        shown = {
            args.first.stem: (first.features[:frames], TRUTH),
            f"between: {share}": (between, PROJECTED),
            args.second.stem: (second.features[:frames], OTHERS[0]),
        }
        rows = {f"share of {args.second.stem}": shares(args.share, frames)[:, 0]}
        actors = world_actors(shown)  # all begin at one place and face one way
        files.write_page(args.output, "both motions and the one between", actors, rows=rows)
    return 0
