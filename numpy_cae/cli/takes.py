"""Motion files, read as takes, with a word about each unit that was guessed."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae.experiments.material import is_test
from numpy_cae.motion.io.cache import read_bodies


def read_takes(
    paths: Sequence[Path],
    mapping: dict[str, str] | None = None,
    unit: float | None = None,
    test: Sequence[str] = (),
    strict: bool = False,
    cache: Path | None = None,
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Each motion file as twenty joints at 30 frames a second.

    Parameters
    ----------
    paths : sequence of paths
    mapping, unit
        As `load_body` takes them.
    test : sequence of str
        Patterns such as "*_005.bvh": files whose name matches one are kept for testing.
    strict : bool
        Whether a file that cannot be used is raised; else it is listed and left out.
    cache : path, optional
        Where what was read is kept for the next time; None for nowhere.

    Returns
    -------
    training, testing : lists of (F, 20, 3) arrays in metres

    Raises
    ------
    MotionFileError, UnknownRigError
        As `load_body` does, where strict or where there is one file.
    ValueError
        If a pattern leaves nothing to test, or all of them nothing to train on.
    """
    for pattern in test:
        if not any(is_test(path, [pattern]) for path in paths):
            raise ValueError(f"no file matches {pattern!r}, none is left to test")
    training, testing, notes, left_out = [], [], Counter(), 0
    following = _Following(len(paths))
    for body in read_bodies(paths, mapping, unit, cache):
        following.one_more()
        if body.problem is not None:
            if strict or len(paths) == 1:
                raise body.problem
            left_out += 1
            print(f"left out: {body.problem}", file=sys.stderr)
            continue
        (testing if is_test(body.path, test) else training).append(body.positions)
        notes[body.note.split(" (")[0]] += 1
    if left_out == len(paths):
        raise ValueError(f"none of {left_out} files can be used, see above")
    if test and not testing:
        raise ValueError("every file to test was left out, see above")
    if not training:
        raise ValueError(f"every file matches {' or '.join(test)}, none is left to train")
    said = f", {left_out} left out" if left_out else ""
    seconds = sum(map(len, training)) / 30
    print(
        f"{len(paths) - left_out} files read{said}: {len(training)} takes to train on "
        f"({seconds / 60:.1f} min), {len(testing)} to test; lengths in "
        + ", ".join(f"{note} ({count})" for note, count in notes.most_common()),
        file=sys.stderr,
    )
    return training, testing


class _Following:
    """A line every few seconds while many files are read, with the time left."""

    def __init__(self, files: int):
        self.files, self.read = files, 0
        self.begun = self.said = time.monotonic()

    def one_more(self) -> None:
        """One more file was read."""
        self.read += 1
        now = time.monotonic()
        if now - self.said > 5:
            self.said = now
            left = (now - self.begun) / self.read * (self.files - self.read)
            print(f"{self.read} of {self.files} files read, {left:.0f} s to go", file=sys.stderr)
