"""Takes to train and to test on, from motion files."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from numpy_cae.cli.shared.output import note, with_progress
from numpy_cae.mocap import Coordinates, MotionFileError, UnknownRigError, find_motion_files
from numpy_cae.mocap.bodies import ReadResult, read_bodies
from numpy_cae.mocap.coordinates import unit_name
from numpy_cae.mocap.load import is_test
from numpy_cae.mocap.rigs.rigs import Mappings

Take = TypeVar("Take")


def read_takes(
    paths: Sequence[Path],
    mapping: Mappings = None,
    coordinates: Coordinates | None = None,
    test: Sequence[str] = (),
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Each motion file as twenty joints at 30 frames a second, (F, 20, 3) in metres, for training
    and for testing.

    Files whose name matches a pattern in `test` are for testing. A file that cannot be used is an
    error of `read_bodies` if it is the only one, otherwise it is reported and skipped.

    Raises ValueError if the patterns leave nothing to test or to train on.
    """
    for pattern in test:
        if not any(is_test(path, [pattern]) for path in paths):
            raise ValueError(f"no file matches {pattern!r}, none is left to test")
    training: list[np.ndarray] = []
    testing: list[np.ndarray] = []
    units: Counter[str] = Counter()
    changed = 0
    for body in usable_bodies(paths, mapping, coordinates):
        (testing if is_test(body.path, test) else training).append(body.positions)
        units[unit_name(body.unit)] += 1
        changed += len(body.notes) > 1
        for doubt in body.notes:
            if doubt.in_doubt:
                note(f"{body.path}: {doubt.text}")
    left_out = len(paths) - units.total()
    if test and not testing:
        raise ValueError("every file to test was left out, see above")
    if not training:
        raise ValueError(f"every file matches {' or '.join(test)}, none is left to train")
    skipped = f", {left_out} left out" if left_out else ""
    note(
        f"{len(paths) - left_out} files read{skipped}: {len(training)} takes to train on "
        f"({minutes_of(training, 30)}), {len(testing)} to test; lengths in "
        + ", ".join(f"{unit} ({count})" for unit, count in units.most_common())
    )
    if changed:
        what = "were turned, moved to a floor at 0 or are odd in another way"
        note(f"{changed} files {what}; see `numpy-cae rig FILE`")
    return training, testing


def minutes_of(takes: Sequence[np.ndarray], rate: float) -> str:
    """The length of takes with `rate` frames a second in minutes, with a warning below ten."""
    minutes = sum(map(len, takes)) / rate / 60
    return f"{minutes:.1f} min" + (", less than 10 is little to learn from" if minutes < 10 else "")


def usable_bodies(
    paths: Sequence[Path], mapping: Mappings, coordinates: Coordinates | None, strict: bool = False
) -> Iterator[ReadResult]:
    """The bodies that `read_bodies` can read. A file that cannot be used is an error if `strict` or
    if it is the only one, otherwise it is reported and skipped; ValueError if all are.
    """
    left_out = 0
    bodies = read_bodies(paths, mapping, coordinates)
    for body in with_progress(bodies, len(paths), "file"):
        if body.problem is None:
            yield body
        elif strict or len(paths) == 1:
            raise body.problem
        else:
            left_out += 1
            note(f"left out: {body.problem}")
    if left_out == len(paths):
        raise ValueError(f"none of {left_out} files can be used, see above")


def each_usable(
    folders: Sequence[str | Path], read: Callable[[Path], Take]
) -> Iterator[tuple[Path, Take]]:
    """Yield the path of every motion file below the folders and what `read` makes of the file.

    A file that cannot be used is reported and left out.
    """
    for path in (path for folder in folders for path in find_motion_files(folder)):
        try:
            take = read(path)
        except (MotionFileError, UnknownRigError) as problem:
            note(f"left out: {problem}")
        else:
            yield path, take
