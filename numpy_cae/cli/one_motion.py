"""Arguments and steps shared by the commands that apply a model to motions."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from numpy_cae.cli import arguments as kinds
from numpy_cae.manifold import ModelFileError, SequenceManifold, load_manifold
from numpy_cae.manifold.model_file import Manifold
from numpy_cae.motion import (
    PARENTS,
    Motion,
    UnknownRigError,
    body_of,
    find_motion_files,
    load_body,
    load_motion,
    write_bvh,
)
from numpy_cae.viz import CORRUPTED, PROJECTED, Actor, save_gif


def add_model_arguments(parser: argparse.ArgumentParser, gif: str = "") -> None:
    """The model, how motion files are read and, with the help of --gif, the file to write."""
    add = parser.add_argument
    add("-m", "--model", type=Path, required=True, help="model file, from `numpy-cae train`")
    if gif:
        add("-o", "--output", type=Path, required=True, help="path of the .bvh file to write")
        add("--gif", type=Path, help=gif)
    kinds.add_motion_arguments(parser)


def add_file_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of a command that changes one motion file."""
    parser.add_argument("file", type=Path, help="motion file (.bvh or .amc) to read")
    add_model_arguments(parser, "path of an animation of the motion before and after")


def add_data_argument(parser: argparse.ArgumentParser, purpose: str) -> None:
    """`--data`, folders of motion files."""
    parser.add_argument("--data", type=Path, nargs="+", metavar="FOLDER", default=[], help=purpose)


def load_model(args: argparse.Namespace, sequential: bool = False, bvh: bool = True) -> Manifold:
    """The model that `--model` names; ValueError if it is sequential and must not be, or, with
    `bvh`, if `--output` is not a .bvh file."""
    if bvh and args.output.suffix.lower() != ".bvh":
        raise ValueError(f"{args.output}: a motion is written as .bvh")
    manifold = load_manifold(args.model)
    if isinstance(manifold, SequenceManifold) and not sequential:
        raise ModelFileError(f"{args.model}: not a convolutional, but a sequential manifold")
    return manifold


def load_features(args: argparse.Namespace, manifold: Manifold) -> list[np.ndarray]:
    """The features of every motion in the folders of `--data`."""
    mapping = kinds.chosen_mapping(args)
    files = [path for folder in args.data for path in find_motion_files(folder)]
    return [manifold.features(load_body(path, mapping, args.unit)[0])[0] for path in files]


def change(
    args: argparse.Namespace,
    changed: Callable[..., Motion],
    before: Callable[[Motion], Motion] = lambda motion: motion,
) -> int:
    """Read a motion, write `changed(motion, mapping=…)` and draw it beside `before(motion)`."""
    mapping = kinds.chosen_mapping(args)
    motion = load_motion(args.file, unit=args.unit)
    print(f"{args.file}: {len(motion)} frames, {motion.unit_note}", file=sys.stderr)
    try:
        result = changed(motion, mapping=mapping)
    except UnknownRigError as error:
        raise UnknownRigError(f"{args.file}: {error}") from None
    write_bvh(result, args.output)
    frames, joints = len(result), len(result.skeleton.names)
    print(f"{args.output}: {frames} frames at {result.rate:g} a second, {joints} joints")
    if args.gif:
        actors = [
            Actor(body_of(before(motion), mapping), PARENTS, "before", CORRUPTED),
            Actor(body_of(result, mapping), PARENTS, "after", PROJECTED),
        ]
        save_gif(actors, args.gif, 30.0)
        print(f"{args.gif}: before and after")
    return 0
