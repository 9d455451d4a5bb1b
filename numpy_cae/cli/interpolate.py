"""`numpy-cae interpolate A B -m model.npz -o out.bvh`: interpolate between two motions."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.manifold import interpolate
from numpy_cae.manifold.interpolate import TRANSITION
from numpy_cae.motion import PARENTS, body_of, load_body, write_bvh
from numpy_cae.viz import PROJECTED, TRUTH, Actor, save_gif


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand and its arguments."""
    parser = subparsers.add_parser(
        "interpolate",
        description="Interpolate between two motions along a learned manifold and write the result "
        "as BVH, with the rig, frame rate and unit of the first. The longer one is truncated.",
        epilog="example: numpy-cae interpolate press_ups.bvh walk.bvh -m model.npz -o between.bvh "
        "--share transition --gif between.gif",
    )
    parser.add_argument("first", type=Path, help="first motion file (.bvh or .amc)")
    parser.add_argument("second", type=Path, help="second motion file, of any rig")
    one_motion.add_model_arguments(parser, "path of an animation of the three motions")
    parser.add_argument(
        "--share",
        type=lambda text: text if text == TRANSITION else kinds.fraction(text),
        default=0.5,
        metavar="S",
        help="weight of the second motion, 0 to 1 (default: 0.5), or `transition`: 0 at the first "
        "frame to 1 at the last",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Interpolate the hidden units of the two motions."""
    manifold, mapping = one_motion.load_model(args), kinds.chosen_mapping(args)
    files = args.first, args.second
    motions = [load_body(path, mapping, args.unit)[1] for path in files]
    first, second = (manifold.body(motion, mapping) for motion in motions)
    between = interpolate(manifold, first.features, second.features, args.share)
    print(
        f"{args.first}: {len(first.features)} frames at 30 a second, "
        f"{args.second}: {len(second.features)}, {len(between)} of them used",
        file=sys.stderr,
    )
    made = first.to_rig(between)
    write_bvh(made, args.output)
    print(f"{args.output}: {len(made)} frames at {made.rate:g} a second")
    if args.gif:
        frames = len(between)
        actors = [
            Actor(first.positions[:frames], PARENTS, args.first.stem, TRUTH),
            Actor(body_of(made, mapping)[:frames], PARENTS, "between", PROJECTED),
            Actor(second.positions[:frames], PARENTS, args.second.stem, TRUTH),
        ]
        save_gif(actors, args.gif, 30.0)
        print(f"{args.gif}: both and the one between")
    return 0
