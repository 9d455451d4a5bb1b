"""`numpy-cae interpolate A B -m model.npz -o out.bvh`: between two motions, along the manifold."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from numpy_cae.cli import arguments as kinds
from numpy_cae.manifold import interpolate, load_manifold
from numpy_cae.manifold.in_rig import in_rig
from numpy_cae.manifold.interpolate import TRANSITION
from numpy_cae.motion import PARENTS, body_of, load_body, write_bvh
from numpy_cae.viz import PROJECTED, TRUTH, Actor, save_gif


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Two files in, model, one file out."""
    parser = subparsers.add_parser(
        "interpolate",
        help="make the motion between two motions",
        description="Interpolate two motions along a learned manifold and write the result as BVH, "
        "in the rig, frame rate and unit of the first. They run side by side from their first "
        "frames on; what the longer one has more is left out.",
        epilog="example: numpy-cae interpolate press_ups.bvh walk.bvh -m model.npz -o between.bvh "
        "--share transition --gif between.gif",
    )
    parser.add_argument("first", type=Path, help="a .bvh or .amc file")
    parser.add_argument("second", type=Path, help="another, of any rig")
    parser.add_argument("-m", "--model", type=Path, required=True, help="from `numpy-cae train`")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the .bvh file to write")
    parser.add_argument(
        "--share",
        type=_share,
        default=0.5,
        metavar="S",
        help="of the second motion, 0 to 1 (default: 0.5), or `transition`: from 0 at the first "
        "frame to 1 at the last",
    )
    parser.add_argument("--gif", type=Path, help="draw both motions and the one between, moving")
    kinds.add_motion_arguments(parser)
    parser.set_defaults(run=run)


def _share(text: str) -> float | str:
    return text if text == TRANSITION else kinds.fraction(text)


def run(args: argparse.Namespace) -> int:
    """Read two, mix their hidden units, write one."""
    if args.output.suffix.lower() != ".bvh":
        raise ValueError(f"{args.output}: an interpolated motion is written as .bvh")
    manifold = load_manifold(args.model)
    mapping = kinds.chosen_mapping(args)
    (first, rig), (second, _) = (
        load_body(path, mapping, args.unit) for path in (args.first, args.second)
    )
    one, start = manifold.features(first)
    other, _ = manifold.features(second)
    between = interpolate(manifold, one, other, args.share)
    print(
        f"{args.first}: {len(one)} frames at 30 a second, {args.second}: {len(other)}, "
        f"{len(between)} of them used",
        file=sys.stderr,
    )
    made = in_rig(manifold, between, start, rig, mapping)
    write_bvh(made, args.output)
    print(f"{args.output}: {len(made)} frames at {made.rate:g} a second")
    if args.gif:
        frames = len(between)
        actors = [
            Actor(first[:frames], PARENTS, args.first.stem, TRUTH),
            Actor(body_of(made, mapping)[:frames], PARENTS, "between", PROJECTED),
            Actor(second[:frames], PARENTS, args.second.stem, TRUTH),
        ]
        save_gif(actors, args.gif, 30.0)
        print(f"{args.gif}: both and the one between")
    return 0
