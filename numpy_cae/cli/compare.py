"""`numpy-cae compare FOLDER -m model.npz -o matrix.csv`: compute distances between motions."""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli import one_motion
from numpy_cae.cli.as_json import add_json_argument, print_json
from numpy_cae.manifold import distance_matrix, hidden_units, load_manifold, signature
from numpy_cae.motion import find_motion_files, load_body


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand and its arguments."""
    parser = subparsers.add_parser(
        "compare",
        help="compute the distances between motions",
        description="Compute G, equation 4 of holden2015, between every two motions, and print "
        "the nearest motion of each. G depends on what happens in a motion, not on when.",
        epilog="example: numpy-cae compare motions/ -m model.npz -o matrix.csv --picture m.png",
    )
    parser.add_argument(
        "motions", type=Path, nargs="+", metavar="FOLDER_OR_FILE", help="a folder, or motion files"
    )
    one_motion.add_model_arguments(parser)
    parser.add_argument("-o", "--output", type=Path, metavar="CSV", help="path of the matrix of G")
    parser.add_argument(
        "--picture",
        type=Path,
        metavar="PNG",
        help="path of a picture of the matrix (√G) with similar motions side by side",
    )
    add_json_argument(parser)
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Compute, print and write the distances."""
    model = load_manifold(args.model)
    manifold = one_motion.require_convolutional(model, args.model, "compare")
    files = _named_files(args.motions)
    if len(files) < 2:
        raise ValueError(f"{args.motions[0]}: one motion alone, name another to compare it with")
    mapping, names = kinds.chosen_mapping(args), list(files)
    clips = [
        manifold.features(load_body(path, mapping, args.unit)[0])[0] for path in files.values()
    ]
    distances = distance_matrix([signature(hidden_units(manifold, clip)) for clip in clips])
    nearest, written = _nearest(names, distances), []
    if args.output:
        _write_csv(names, distances, args.output)
        written.append(f"{args.output}: G of {len(names)} motions")
    if args.picture:
        from numpy_cae.viz import save_figure
        from numpy_cae.viz.matrix import matrix_figure

        # G is a sum of squares; its root is comparable to a length.
        save_figure(matrix_figure(np.sqrt(distances), names, "√G"), args.picture)
        written.append(f"{args.picture}: √G of {len(names)} motions, clustered")
    if args.json:
        compared = {"distance": "G", "motions": names, "matrix": distances}
        print_json({**compared, "nearest": [other for other, _ in nearest]})
        return 0
    for name, (other, distance) in zip(names, nearest, strict=True):
        print(f"{name}: nearest is {other}, G = {distance:.3f}")
    print("\n".join(written), end="\n" if written else "")
    return 0


def _named_files(motions: Sequence[Path]) -> dict[str, Path]:
    """Every motion file by a unique name: its path below its folder, or its whole path."""
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
    """For each motion the nearest other one, and its distance."""
    others = np.where(np.eye(len(names), dtype=bool), np.inf, distances)
    return [(names[int(np.argmin(row))], float(row.min())) for row in others]


def _write_csv(names: list[str], distances: np.ndarray, path: Path) -> None:
    with atomic_write(path) as beside, open(beside, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["", *names])
        for name, row in zip(names, distances, strict=True):
            rows.writerow([name, *[f"{g:.6g}" for g in row]])
