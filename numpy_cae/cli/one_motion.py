"""What `repair` and `fill` share: a motion file in, a manifold, the same rig out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from numpy_cae.cli import arguments as kinds
from numpy_cae.manifold import MotionManifold, load_manifold
from numpy_cae.motion import PARENTS, Motion, UnknownRigError, body_of, load_motion, write_bvh
from numpy_cae.viz import CORRUPTED, PROJECTED, Actor, save_gif

Mapping = dict[str, str] | None


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The file, the model, what to write."""
    parser.add_argument("file", type=Path, help="a .bvh or .amc file")
    parser.add_argument("-m", "--model", type=Path, required=True, help="from `numpy-cae train`")
    parser.add_argument("-o", "--output", type=Path, required=True, help="the .bvh file to write")
    parser.add_argument("--gif", type=Path, help="draw before and after, moving")
    kinds.add_motion_arguments(parser)


def change(
    args: argparse.Namespace,
    changed: Callable[[Motion, MotionManifold, Mapping], Motion],
    came_as: Callable[[Motion], Motion] = lambda motion: motion,
    load: Callable[[Path], MotionManifold] = load_manifold,
) -> int:
    """Read, change, write, draw.

    Parameters
    ----------
    args : Namespace
        With what `add_arguments` adds.
    changed : function of motion, manifold and mapping
    came_as : function of motion
        How the motion that came in is drawn.
    load : function of a path
        What reads the model.
    """
    if args.output.suffix.lower() != ".bvh":
        raise ValueError(f"{args.output}: a motion is written as .bvh")
    manifold = load(args.model)
    mapping = kinds.chosen_mapping(args)
    motion = load_motion(args.file, unit=args.unit)
    print(f"{args.file}: {len(motion)} frames, {motion.unit_note}", file=sys.stderr)
    try:
        result = changed(motion, manifold, mapping)
    except UnknownRigError as error:
        raise UnknownRigError(f"{args.file}: {error}") from None
    write_bvh(result, args.output)
    print(
        f"{args.output}: {len(result)} frames at {result.rate:g} a second, "
        f"{len(result.skeleton.names)} joints"
    )
    if args.gif:
        before = Actor(body_of(came_as(motion), mapping), PARENTS, "before", CORRUPTED)
        after = Actor(body_of(result, mapping), PARENTS, "after", PROJECTED)
        save_gif([before, after], args.gif, manifold.rate)
        print(f"{args.gif}: before and after")
    return 0
