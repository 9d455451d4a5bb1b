"""Arguments and steps shared by the commands that apply a model to motions."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from numpy_cae.cli import arguments as kinds
from numpy_cae.manifold import ModelFileError, MotionManifold, SequenceManifold, load_manifold
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

Mapping = dict[str, str] | None
Manifold = MotionManifold | SequenceManifold


def add_model_arguments(parser: argparse.ArgumentParser, gif: str | None = None) -> None:
    """The model, how motion files are read and, with the help of --gif, the file to write."""
    parser.add_argument(
        "-m", "--model", type=Path, required=True, help="model file, from `numpy-cae train`"
    )
    if gif:
        parser.add_argument(
            "-o", "--output", type=Path, required=True, help="path of the .bvh file to write"
        )
        parser.add_argument("--gif", type=Path, metavar="GIF", help=gif)
    kinds.add_motion_arguments(parser)


def add_file_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of a command that changes one motion file."""
    parser.add_argument("file", type=Path, help="motion file (.bvh or .amc) to read")
    add_model_arguments(parser, "path of an animation of the motion before and after")


def add_data_argument(parser: argparse.ArgumentParser, help_text: str) -> None:
    """`--data`, folders of motion files."""
    parser.add_argument(
        "--data", type=Path, nargs="+", metavar="FOLDER", default=[], help=help_text
    )


def load_model(args: argparse.Namespace) -> Manifold:
    """The model that `--model` names; ValueError unless `--output` is a .bvh file."""
    if args.output.suffix.lower() != ".bvh":
        raise ValueError(f"{args.output}: a motion is written as .bvh")
    return load_manifold(args.model)


def require_convolutional(manifold: Manifold, path: Path, command: str) -> MotionManifold:
    """The manifold; ModelFileError if it is sequential."""
    if isinstance(manifold, SequenceManifold):
        raise ModelFileError(f"{path}: {command} needs a convolutional, not a sequential manifold")
    return manifold


def load_features(args: argparse.Namespace, manifold: MotionManifold) -> list[np.ndarray]:
    """The features of every motion in the folders of `--data`."""
    mapping = kinds.chosen_mapping(args)
    files = [path for folder in args.data for path in find_motion_files(folder)]
    return [manifold.features(load_body(path, mapping, args.unit)[0])[0] for path in files]


def change(
    args: argparse.Namespace,
    manifold: Manifold,
    changed: Callable[[Motion, Mapping], Motion],
    before: Callable[[Motion], Motion] = lambda motion: motion,
) -> int:
    """Read the motion, write what `changed` returns, and draw both.

    `before` returns the motion that is drawn as the one before.
    """
    mapping = kinds.chosen_mapping(args)
    motion = load_motion(args.file, unit=args.unit)
    print(f"{args.file}: {len(motion)} frames, {motion.unit_note}", file=sys.stderr)
    try:
        result = changed(motion, mapping)
    except UnknownRigError as error:
        raise UnknownRigError(f"{args.file}: {error}") from None
    write_motion(result, args.output, f", {len(result.skeleton.names)} joints")
    if args.gif:
        from numpy_cae.viz import CORRUPTED, PROJECTED

        bodies = [body_of(before(motion), mapping), body_of(result, mapping)]
        colours = [CORRUPTED, PROJECTED]
        draw(args.gif, bodies, ["before", "after"], colours, manifold.rate, "before and after")
    return 0


def write_motion(motion: Motion, path: Path, more: str = "") -> None:
    """Write a motion and print what was written."""
    write_bvh(motion, path)
    print(f"{path}: {len(motion)} frames at {motion.rate:g} a second{more}")


def draw(
    path: Path,
    bodies: Sequence[np.ndarray],
    titles: Sequence[str],
    colours: Sequence[str],
    rate: float,
    content: str,
) -> None:
    """Draw bodies (F, 20, 3) side by side as an animation and print what was drawn."""
    from numpy_cae.viz import Actor, save_gif

    actors = [
        Actor(body, PARENTS, title, colour)
        for body, title, colour in zip(bodies, titles, colours, strict=True)
    ]
    save_gif(actors, path, rate)
    print(f"{path}: {content}")
