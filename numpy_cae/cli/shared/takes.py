"""Takes to train and to test on, from motion files."""

from collections.abc import Callable, Iterable, Iterator, Sequence, Sized
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from numpy_cae.cli.shared.output import note, with_progress
from numpy_cae.mocap.bodies import Problem, read_body, read_each
from numpy_cae.mocap.load import is_test
from numpy_cae.motion import RATE

Take = TypeVar("Take", bound=Sized)


def read_takes(
    paths: Sequence[Path], test: Sequence[str], **options: Any
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Each motion file as twenty joints at 30 frames a second, (F, 20, 3) in metres, in two halves
    as those of `in_halves`; options as in `load_motion`."""
    takes = []
    changed = 0
    for path, (positions, notes) in usable(paths, partial(read_body, **options)):
        takes.append((path, positions))
        changed += len(notes) > 1
        for doubt in notes:
            if doubt.in_doubt:
                note(f"{path}: {doubt.text}")
    if changed:
        what = "were turned, moved to a floor at 0 or are odd in another way"
        note(f"{changed} files {what}; see `numpy-cae rig FILE`")
    return in_halves(takes, test, RATE)


def in_halves(
    takes: Iterable[tuple[Path, Take]], test: Sequence[str], rate: float
) -> tuple[list[Take], list[Take]]:
    """The takes to train on, and those to test on, whose file's name matches a pattern in `test`.

    Says how many there are; `rate` is their frames a second. Raises ValueError if a pattern matches
    no take, or none is left to train on.
    """
    takes = list(takes)
    for pattern in test:
        if not any(is_test(path, [pattern]) for path, _ in takes):
            raise ValueError(f"no file that was read matches {pattern!r}, none is left to test on")
    training = [take for path, take in takes if not is_test(path, test)]
    testing = [take for path, take in takes if is_test(path, test)]
    if not training:
        raise ValueError(f"every file matches {' '.join(test)}, none is left to train on")
    minutes = sum(map(len, training)) / rate / 60
    few = ", less than 10 is little to learn from" if minutes < 10 else ""
    note(f"{len(training)} takes to train on ({minutes:.1f} min{few}), {len(testing)} to test on")
    return training, testing


def usable(
    paths: Sequence[Path], read: Callable[[Path], Take], strict: bool = False
) -> Iterator[tuple[Path, Take]]:
    """Each file that `read` can read, and what `read` makes of it. A file that cannot be used is an
    error if `strict` or if it is the only one, otherwise it is reported and skipped; ValueError if
    all are."""
    left_out = 0
    takes = with_progress(read_each(paths, read), len(paths), "file")
    for path, take in zip(paths, takes, strict=True):
        if not isinstance(take, Problem):
            yield path, take
        elif strict or len(paths) == 1:
            raise take
        else:
            left_out += 1
            note(f"left out: {take}")
    if left_out == len(paths):
        raise ValueError(f"none of {left_out} files can be used, see above")
