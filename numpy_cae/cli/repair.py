"""`numpy-cae repair FILE -m model.npz -o fixed.bvh`: a damaged motion onto the manifold."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from numpy_cae.cli import arguments as kinds
from numpy_cae.manifold import load_manifold, repair
from numpy_cae.motion import PARENTS, UnknownRigError, body_of, load_motion, write_bvh
from numpy_cae.viz import CORRUPTED, PROJECTED, Actor, save_gif


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """File in, model, file out."""
    parser = subparsers.add_parser(
        "repair",
        help="project a damaged motion onto a manifold",
        description="Project a motion onto a learned manifold and write the result as BVH, "
        "in the rig, frame rate, unit and length of the file that came in. Fingers and other "
        "joints beyond the twenty that the manifold knows are carried along.",
        epilog="example: numpy-cae repair take.bvh -m model.npz -o fixed.bvh --gif fixed.gif",
    )
    parser.add_argument("file", type=Path, help="a .bvh, .amc or .txt file")
    parser.add_argument("-m", "--model", type=Path, required=True, help="from `numpy-cae train`")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the .bvh file to write")
    parser.add_argument("--gif", type=Path, help="draw before and after, moving")
    kinds.add_motion_arguments(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, project, write."""
    if args.output.suffix.lower() != ".bvh":
        raise ValueError(f"{args.output}: a repaired motion is written as .bvh")
    manifold = load_manifold(args.model)
    mapping = kinds.chosen_mapping(args)
    motion = load_motion(args.file, unit=args.unit)
    print(f"{args.file}: {len(motion)} frames, {motion.unit_note}", file=sys.stderr)
    try:
        fixed = repair(motion, manifold, mapping)
    except UnknownRigError as error:
        raise UnknownRigError(f"{args.file}: {error}") from None
    write_bvh(fixed, args.output)
    print(
        f"{args.output}: {len(fixed)} frames at {fixed.rate:g} a second, "
        f"{len(fixed.skeleton.names)} joints"
    )
    if args.gif:
        before = Actor(body_of(motion, mapping), PARENTS, "before", CORRUPTED)
        after = Actor(body_of(fixed, mapping), PARENTS, "after", PROJECTED)
        save_gif([before, after], args.gif, 30.0)
        print(f"{args.gif}: before and after")
    return 0
