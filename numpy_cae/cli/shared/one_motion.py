"""Arguments and steps shared by the commands that apply a model to motions."""

import argparse
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import arguments
from numpy_cae.manifold import ModelFileError, SequenceManifold, load_manifold, starter
from numpy_cae.manifold.model_file import Manifold
from numpy_cae.motion import JOINTS, PARENTS, Motion, write_motion
from numpy_cae.motion.formats.write import require_writer
from numpy_cae.viz import Actor, save_gif, save_viewer

RATE = 30.0
"""Frames a second of animations."""


def add_model_arguments(parser: argparse.ArgumentParser, gif: str = "") -> None:
    """The model, how motion files are read and, with the help of --gif, the file to write."""
    add = parser.add_argument
    model = "model file from `numpy-cae train` (default: the starter model of the package)"
    add("-m", "--model", type=Path, help=model)
    if gif:
        output = "path of the file to write: .bvh, .glb (glTF), .npz or .csv (positions)"
        add("-o", "--output", type=Path, required=True, help=output)
        add_pictures(parser, gif)
    arguments.add_shared(parser, "mapping unit up floor")


def add_pictures(parser: argparse.ArgumentParser, gif: str) -> None:
    """--gif, with its help, and --html."""
    parser.add_argument("--gif", type=Path, help=gif)
    page = "write the same as an interactive page beside the output, for any browser"
    parser.add_argument("--html", **arguments.FLAG, help=page)


def load_model(args: argparse.Namespace, sequential: bool = False, motion: bool = True) -> Manifold:
    """The model that `--model` names, by default the starter model; ValueError if it is sequential
    and must not be, or, with `motion`, if no motion can be written to `--output`."""
    if motion:
        require_writer(args.output)
    if args.model and not args.model.exists():
        raise ModelFileError(f"{args.model}: no such file; leave -m out for the starter model")
    manifold = load_manifold(args.model) if args.model else starter()
    if isinstance(manifold, SequenceManifold) and not sequential:
        raise ModelFileError(f"{args.model}: not a convolutional, but a sequential manifold")
    return manifold


def write(motion: Motion, path: Path) -> None:
    """Write a motion and print what was written."""
    write_motion(motion, path)
    print_written(motion, path)


def print_written(motion: Motion, path: Path) -> None:
    """Print a file's name with the size of its motion."""
    joints = len(motion.skeleton.names) - motion.skeleton.added
    print(f"{path}: {len(motion)} frames at {motion.rate:g} a second, {joints} joints")


def body_actor(body: np.ndarray, label: str, colour: str) -> Actor:
    """The twenty joints (F, 20, 3) at `RATE`, to be drawn."""
    return Actor(body, PARENTS, label, colour, JOINTS)


def draw(
    args: argparse.Namespace,
    output: Path,
    content: str,
    actors: list[Actor],
    overlaid: bool = False,
) -> None:
    """Draw motions at `RATE` if `--gif` or `--html`, a page beside the output, says so."""
    if args.gif:
        shown = save_gif(actors, args.gif, RATE, overlaid=overlaid)
        print(f"{args.gif}: {content}, {shown}")
    if args.html:
        page = output.with_suffix(".html")
        save_viewer(actors, page, RATE, f"{output.stem}: {content}", overlaid)
        print(f"{page}: {content}; open it in a browser")
