"""Motion files, read as takes, with a word about each unit that was guessed."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae.experiments.material import is_test
from numpy_cae.motion import load_body


def read_takes(
    paths: Sequence[Path],
    mapping: dict[str, str] | None = None,
    unit: float | None = None,
    test: Sequence[str] = (),
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Each motion file as twenty joints at 30 frames a second.

    Parameters
    ----------
    paths : sequence of paths
    mapping, unit
        As `load_body` takes them.
    test : sequence of str
        Patterns such as "*_005.bvh": files whose name matches one are kept for testing.

    Returns
    -------
    training, testing : lists of (F, 20, 3) arrays in metres

    Raises
    ------
    MotionFileError, UnknownRigError
        As `load_body` does.
    ValueError
        If a pattern leaves nothing to test, or all of them nothing to train on.
    """
    for pattern in test:
        if not any(is_test(path, [pattern]) for path in paths):
            raise ValueError(f"no file matches {pattern!r}, none is left to test")
    training, testing, notes = [], [], Counter()
    for path in paths:
        positions, motion = load_body(path, mapping, unit)
        (testing if is_test(path, test) else training).append(positions)
        notes[motion.unit_note.split(" (")[0]] += 1
    if not training:
        raise ValueError(f"every file matches {' or '.join(test)}, none is left to train")
    seconds = sum(map(len, training)) / 30
    print(
        f"{len(paths)} files read: {len(training)} takes to train on ({seconds / 60:.1f} min), "
        f"{len(testing)} to test; lengths in "
        + ", ".join(f"{note} ({count})" for note, count in notes.most_common()),
        file=sys.stderr,
    )
    return training, testing
