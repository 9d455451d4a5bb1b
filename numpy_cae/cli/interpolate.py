"""`numpy-cae interpolate A B -m model.npz -o out.bvh`: interpolate between two motions."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.manifold import interpolate
from numpy_cae.manifold.interpolate import TRANSITION
from numpy_cae.motion import body_of, load_body


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand and its arguments."""
    parser = subparsers.add_parser(
        "interpolate",
        help="interpolate between two motions along a manifold",
        description="Interpolate between two motions along a learned manifold and write the result "
        "as BVH, with the rig, frame rate and unit of the first. Both start at their first frame; "
        "the longer one is truncated.",
        epilog="example: numpy-cae interpolate press_ups.bvh walk.bvh -m model.npz -o between.bvh "
        "--share transition --gif between.gif",
    )
    parser.add_argument("first", type=Path, help="first motion file (.bvh or .amc)")
    parser.add_argument("second", type=Path, help="second motion file, of any rig")
    one_motion.add_model_arguments(
        parser, "path of an animation of both motions and the one between"
    )
    parser.add_argument(
        "--share",
        type=_share,
        default=0.5,
        metavar="S",
        help="weight of the second motion from 0 to 1 (default: 0.5), or `transition`: from 0 at "
        "the first frame to 1 at the last",
    )
    parser.set_defaults(run=run)


def _share(text: str) -> float | str:
    return text if text == TRANSITION else kinds.fraction(text)


def run(args: argparse.Namespace) -> int:
    """Interpolate the hidden units of the two motions."""
    model = one_motion.load_model(args)
    manifold = one_motion.require_convolutional(model, args.model, "interpolate")
    mapping = kinds.chosen_mapping(args)
    first, second = (
        manifold.body(load_body(path, mapping, args.unit)[1], mapping)
        for path in (args.first, args.second)
    )
    between = interpolate(manifold, first.features, second.features, args.share)
    print(
        f"{args.first}: {len(first.features)} frames at 30 a second, "
        f"{args.second}: {len(second.features)}, {len(between)} of them used",
        file=sys.stderr,
    )
    made = first.to_rig(between)
    one_motion.write_motion(made, args.output)
    if args.gif:
        from numpy_cae.viz import PROJECTED, TRUTH

        frames = len(between)
        bodies = [first.positions, body_of(made, mapping), second.positions]
        titles = [args.first.stem, "between", args.second.stem]
        one_motion.draw(
            args.gif,
            [body[:frames] for body in bodies],
            titles,
            [TRUTH, PROJECTED, TRUTH],
            30.0,
            "both and the one between",
        )
    return 0
