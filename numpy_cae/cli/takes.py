"""Motion files, read as takes, with a word about each unit that was guessed."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path

import numpy as np

from numpy_cae.motion import load_body


def read_takes(
    paths: Sequence[Path],
    mapping: dict[str, str] | None = None,
    unit: float | None = None,
    test: str | None = None,
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Each motion file as twenty joints at 30 frames a second.

    Parameters
    ----------
    paths : sequence of paths
    mapping, unit
        As `load_body` takes them.
    test : str, optional
        A pattern such as "*_005.bvh": files whose name matches are kept for testing.

    Returns
    -------
    training, testing : lists of (F, 20, 3) arrays in metres

    Raises
    ------
    MotionFileError, UnknownRigError
        As `load_body` does.
    ValueError
        If the pattern leaves nothing to test or nothing to train on.
    """
    training, testing, notes = [], [], Counter()
    for path in paths:
        positions, motion = load_body(path, mapping, unit)
        kept = test is not None and fnmatch(path.name, test)
        (testing if kept else training).append(positions)
        notes[motion.unit_note.split(" (")[0]] += 1
    if test is not None and not testing:
        raise ValueError(f"no file matches {test!r}, none is left to test")
    if not training:
        raise ValueError(f"every file matches {test!r}, none is left to train")
    seconds = sum(map(len, training)) / 30
    print(
        f"{len(paths)} files read: {len(training)} takes to train on ({seconds / 60:.1f} min), "
        f"{len(testing)} to test; lengths in "
        + ", ".join(f"{note} ({count})" for note, count in notes.most_common()),
        file=sys.stderr,
    )
    return training, testing
