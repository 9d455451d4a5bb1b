"""Options and steps of the commands that apply a model to motions."""

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from numpy_cae.cli.shared import arguments
from numpy_cae.manifold import ModelFileError, SequenceManifold, load_manifold, starter
from numpy_cae.manifold.model_file import Manifold
from numpy_cae.mocap import write_bvh
from numpy_cae.motion import RATE, Motion
from numpy_cae.viz import Actor, save_viewer


def add_model_arguments(parser: argparse.ArgumentParser) -> None:
    """The model, and how motion files are read."""
    model = "model file from `numpy-cae train` (default: the starter model of the package)"
    parser.add_argument("-m", "--model", type=Path, help=model)
    arguments.add_shared(parser, "mapping unit up floor")


def add_output_arguments(parser: argparse.ArgumentParser) -> None:
    """The motion file to write, and the page."""
    parser.add_argument("-o", "--output", type=Path, required=True, help="motion file, .bvh")
    arguments.add_shared(parser, "html")


def load_model(args: argparse.Namespace, sequential: bool = False) -> Manifold:
    """The model that `--model` names, by default the starter model.

    Raises ModelFileError if there is no such file, or if the model is sequential and `sequential`
    is False.
    """
    if args.model and not args.model.exists():
        raise ModelFileError(f"{args.model}: no such file; leave -m out for the starter model")
    manifold = load_manifold(args.model) if args.model else starter()
    if isinstance(manifold, SequenceManifold) and not sequential:
        raise ModelFileError(f"{args.model}: not a convolutional, but a sequential manifold")
    return manifold


def write(motion: Motion, path: Path) -> None:
    """Write a motion and print what was written."""
    write_bvh(motion, path)
    print(f"{path}: {motion}")


def write_page(
    output: Path, content: str, actors: list[Actor], rows: Mapping[str, np.ndarray] | None = None
) -> None:
    """Write a page beside the output that plays motions at thirty frames a second, with rows of
    bars below them."""
    page = output.with_suffix(".html")
    save_viewer(actors, page, RATE, f"{output.stem}: {content}", rows=rows or {})
    print(f"{page}: {content}; open it in a browser")
