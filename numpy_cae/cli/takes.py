"""Read motion files as takes and report files and guessed units."""

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
        See `load_body`.
    test : sequence of str
        Patterns such as "*_005.bvh": files whose name matches one are for testing.
    strict : bool
        Whether a file that cannot be used is an error; otherwise it is reported and skipped.
    cache : path, optional
        Folder of the cache of `read_bodies`; None for no cache.

    Returns
    -------
    training, testing : lists of (F, 20, 3) arrays in metres

    Raises
    ------
    MotionFileError, UnknownRigError
        As `load_body`, if strict or if there is only one file.
    ValueError
        If a pattern leaves nothing to test, or all of them nothing to train on.
    """
    for pattern in test:
        if not any(is_test(path, [pattern]) for path in paths):
            raise ValueError(f"no file matches {pattern!r}, none is left to test")
    training: list[np.ndarray] = []
    testing: list[np.ndarray] = []
    notes: Counter[str] = Counter()
    left_out = 0
    progress = _Progress(len(paths))
    for body in read_bodies(paths, mapping, unit, cache):
        progress.advance()
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
    skipped = f", {left_out} left out" if left_out else ""
    seconds = sum(map(len, training)) / 30
    print(
        f"{len(paths) - left_out} files read{skipped}: {len(training)} takes to train on "
        f"({seconds / 60:.1f} min), {len(testing)} to test; lengths in "
        + ", ".join(f"{note} ({count})" for note, count in notes.most_common()),
        file=sys.stderr,
    )
    return training, testing


class _Progress:
    """Print the remaining time every few seconds while many files are read."""

    def __init__(self, files: int):
        self.files, self.read = files, 0
        self.begun = self.printed = time.monotonic()

    def advance(self) -> None:
        """Count one more file."""
        self.read += 1
        now = time.monotonic()
        if now - self.printed > 5:
            self.printed = now
            left = (now - self.begun) / self.read * (self.files - self.read)
            print(f"{self.read} of {self.files} files read, {left:.0f} s to go", file=sys.stderr)
