"""Compute the distance G (equation 4 of holden2015) between every two motions, and print the
nearest motion of each. G compares the largest and the smallest value of each hidden unit, wherever
in the motions they occur.

example, with the files that `numpy-cae demo` writes:
  numpy-cae compare demo/ -o matrix.csv --picture matrix.png
"""

import argparse
import csv
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli.shared import arguments, files
from numpy_cae.manifold import distance_matrix, hidden_units, signature
from numpy_cae.visible import csv_cell, visible
from numpy_cae.viz import matrix_figure, save_figure


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The motions, the model and the files to write."""
    add = parser.add_argument
    add("motions", type=Path, nargs="+", metavar="FOLDER_OR_FILE", help="folders or motion files")
    files.add_model_arguments(parser)
    add("-o", "--output", type=Path, metavar="CSV", help="path of the matrix of G")
    add("--picture", type=Path, metavar="PNG", help="path of a picture of the matrix")
    arguments.add_shared(parser, "overwrite")


def run(args: argparse.Namespace) -> int:
    """Compute, print and write the distances."""
    arguments.require_different({"-o": args.output, "--picture": args.picture})
    manifold = files.load_model(args)
    below = files.named_files(args.motions)
    is_unique = len(set(below.values())) == len(below)
    name_of = {path: name.as_posix() if is_unique else str(path) for path, name in below.items()}
    names = []
    signatures = []
    for path, positions in files.read_bodies(args, list(name_of), strict=len(name_of) == 2):
        names.append(visible(name_of[path]))
        features = manifold.features(positions)[0]
        signatures.append(signature(hidden_units(manifold, features)))
    if len(names) < 2:
        raise ValueError(f"{names[0]}: one motion alone, name another to compare it with")
    distances = distance_matrix(signatures)
    _print_nearest(names, distances)
    if args.output:
        _write_csv(names, distances, args.output)
        print(f"{args.output}: G of {len(names)} motions")
    if args.picture:
        title = f"√G of {len(names)} motions; dark: near"
        save_figure(matrix_figure(np.sqrt(distances), names, "√G", title), args.picture)
        print(f"{args.picture}: √G of {len(names)} motions")
    return 0


def _print_nearest(names: list[str], distances: np.ndarray) -> None:
    """Print the motion that is nearest to each, which is not itself."""
    is_itself = np.eye(len(names), dtype=bool)
    distances = np.where(is_itself, np.inf, distances)
    for name, row in zip(names, distances, strict=True):
        nearest = row.argmin()
        print(f"{name}: nearest is {names[nearest]}, G = {row[nearest]:.3f}")


def _write_csv(names: list[str], distances: np.ndarray, path: Path) -> None:
    with atomic_write(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["", *map(csv_cell, names)])
        for name, row in zip(names, distances, strict=True):
            rows.writerow([csv_cell(name), *[f"{g:.6g}" for g in row]])
