"""`numpy-cae compare FOLDER -m model.npz -o matrix.csv`: how unlike motions are."""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.as_json import add_json_argument, print_json
from numpy_cae.manifold import (
    distance_matrix,
    hidden_units,
    load_manifold,
    signature,
)
from numpy_cae.motion import find_motion_files, load_body
from numpy_cae.viz import save_figure
from numpy_cae.viz.matrix import matrix_figure


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Files or folders in, a table and its picture out."""
    parser = subparsers.add_parser(
        "compare",
        help="measure how unlike motions are",
        description="Compare every motion with every other by G, equation 4 of holden2015: what "
        "happens counts, when it happens does not. "
        "Prints the nearest of each.",
        epilog="example: numpy-cae compare motions/ -m model.npz -o matrix.csv --picture m.png",
    )
    parser.add_argument(
        "motions", type=Path, nargs="+", metavar="FOLDER_OR_FILE", help="a folder, or files"
    )
    parser.add_argument("-m", "--model", type=Path, required=True, help="from `numpy-cae train`")
    parser.add_argument("-o", "--output", type=Path, metavar="CSV", help="write the matrix")
    parser.add_argument(
        "--picture",
        type=Path,
        metavar="PNG",
        help="draw it (√G), motions that are alike side by side",
    )
    add_json_argument(parser)
    kinds.add_motion_arguments(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Read, encode, compare, write."""
    manifold = load_manifold(args.model)
    files = _named_files(args.motions)
    if len(files) < 2:
        raise ValueError(f"{args.motions[0]}: one motion alone, name another to compare it with")
    mapping = kinds.chosen_mapping(args)
    clips = [
        manifold.features(load_body(path, mapping, args.unit)[0])[0] for path in files.values()
    ]
    names, distances = (
        list(files),
        distance_matrix([signature(hidden_units(manifold, clip)) for clip in clips]),
    )
    nearest, said = _nearest(names, distances), []
    if args.output:
        _write_csv(names, distances, args.output)
        said.append(f"{args.output}: G of {len(names)} motions")
    if args.picture:
        # G is a sum of squares, and a length is none.
        save_figure(matrix_figure(np.sqrt(distances), names, "√G"), args.picture)
        said.append(f"{args.picture}: √G of {len(names)} motions, clustered")
    if args.json:
        compared = {"distance": "G", "motions": names, "matrix": distances}
        print_json({**compared, "nearest": [other for other, _ in nearest]})
        return 0
    for name, (other, length) in zip(names, nearest, strict=True):
        print(f"{name}: nearest is {other}, G = {length:.3f}")
    for line in said:
        print(line)
    return 0


def _named_files(motions: Sequence[Path]) -> dict[str, Path]:
    """Every motion file by a name that tells it from the others.

    A file of a folder bears its path below that folder, where that is enough.
    """
    short, whole = {}, {}
    count = 0
    for each in motions:
        found = find_motion_files(each) if each.is_dir() else [each]
        for path in found:
            name = path.relative_to(each).as_posix() if each.is_dir() else path.name
            short[name], whole[str(path)] = path, path
            count += 1
    return short if len(short) == count else whole


def _nearest(names: list[str], distances: np.ndarray) -> list[tuple[str, float]]:
    """Of each motion the other that is least unlike it, and how unlike."""
    others = np.where(np.eye(len(names), dtype=bool), np.inf, distances)
    return [(names[int(np.argmin(row))], float(row.min())) for row in others]


def _write_csv(names: list[str], distances: np.ndarray, path: Path) -> None:
    with atomic_write(path) as beside, open(beside, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["", *names])
        rows.writerows(
            [name, *[f"{g:.6g}" for g in row]] for name, row in zip(names, distances, strict=True)
        )
