"""Arguments and steps shared by the commands that apply a model to motions."""

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np

from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.output import note
from numpy_cae.manifold import ModelFileError, SequenceManifold, load_manifold, starter
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
    model = "model file from `numpy-cae train` (default: the starter model)"
    add("-m", "--model", type=Path, help=model)
    if gif:
        add("-o", "--output", type=Path, required=True, help="path of the .bvh file to write")
        add("--gif", type=Path, help=gif)
    kinds.add_shared(parser, "mapping unit up floor")


def add_file_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of a command that changes one motion file."""
    parser.add_argument("file", type=Path, help="motion file (.bvh or .amc) to read")
    add_model_arguments(parser, "path of an animation of the motion before and after")


def load_model(args: argparse.Namespace, sequential: bool = False, bvh: bool = True) -> Manifold:
    """The model that `--model` names; ValueError if it is sequential and must not be, or, with
    `bvh`, if `--output` is not a .bvh file."""
    if bvh and args.output.suffix.lower() != ".bvh":
        raise ValueError(f"{args.output}: a motion is written as .bvh")
    manifold = load_manifold(args.model) if args.model else starter()
    if isinstance(manifold, SequenceManifold) and not sequential:
        raise ModelFileError(f"{args.model}: not a convolutional, but a sequential manifold")
    return manifold


def load_features(args: argparse.Namespace, manifold: Manifold) -> list[np.ndarray]:
    """The features of every motion in the folders of `--data`."""
    mapping = kinds.chosen_mapping(args)
    files = [path for folder in args.data or [] for path in find_motion_files(folder)]
    return [
        manifold.features(load_body(path, mapping, kinds.chosen_coordinates(args))[0])[0]
        for path in files
    ]


def write(motion: Motion, path: Path) -> None:
    """Write a motion as BVH and print what was written."""
    write_bvh(motion, path)
    joints = len(motion.skeleton.names)
    print(f"{path}: {len(motion)} frames at {motion.rate:g} a second, {joints} joints")


def animate(path: Path | None, content: str, *actors: tuple[np.ndarray, str, str]) -> None:
    """Write an animation of bodies, each with its name and colour, unless the path is None."""
    if path:
        save_gif([Actor(body, PARENTS, name, colour) for body, name, colour in actors], path, 30.0)
        print(f"{path}: {content}")


def change(
    args: argparse.Namespace,
    changed: Callable[..., Motion],
    before: Callable[[Motion], Motion] = lambda motion: motion,
) -> int:
    """Read a motion, write `changed(motion, mapping=…)` and draw it beside `before(motion)`."""
    mapping = kinds.chosen_mapping(args)
    known = vars(kinds.chosen_coordinates(args))
    motion = load_motion(args.file, mapping=mapping, **known)
    note(f"{args.file}: {len(motion)} frames, {motion.unit_note}")
    try:
        result = changed(motion, mapping=mapping)
    except UnknownRigError as error:
        raise UnknownRigError(f"{args.file}: {error}") from None
    write(result, args.output)
    if args.gif:
        bodies = [body_of(each, mapping) for each in (before(motion), result)]
        drawn = (bodies[0], "before", CORRUPTED), (bodies[1], "after", PROJECTED)
        animate(args.gif, "before and after", *drawn)
    return 0
