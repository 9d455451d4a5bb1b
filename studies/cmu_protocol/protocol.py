"""Missing data in the walks and jogs of CMU subject 35: a public protocol with published results.

Taylor, Hinton and Roweis, "Modeling human motion using binary latent variables" (NIPS 2006), chose
the takes and the error SC; Lawrence, "Learning for larger datasets with the Gaussian process latent
variable model" (AISTATS 2007), the columns and the angular error. From row 63 of take 35_29 on the
right leg or the upper body is hidden; all other columns and all rows before are given.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from numpy_cae.array_file import load_arrays
from numpy_cae.mocap.formats.amc import amc_values

GROUPS = {"leg": list(range(7, 14)), "body": list(range(20, 50))}
"""Columns of the 59 that are hidden, from 0: the right leg, the upper body."""
FIRST_HIDDEN = 62
TRAINING = [n for n in range(1, 35) if n not in (18, 27, 29)]
"""Numbers of the takes to train on. 18 is a second test take that the published table lacks; 27 is
not in the data set."""
TEST = 29
STEP = 4
"""Every fourth of 120 frames a second."""
FOLDS = 5
ANGLES = np.r_[6:38, 40:47, 48:50, 52:59, 60:62]
"""Columns of the Acclaim file, from 0, whose angles the protocol keeps."""

Fill = Callable[[np.ndarray, int], np.ndarray]
"""A take (F, 59), standardised, with NaN where it is hidden, and the first hidden row to the values
(F, H) of the hidden columns."""


@dataclass(frozen=True, eq=False)
class Protocol:
    """The takes as the protocol's rows (F, 59), in radians and the file's unit of length."""

    takes: list[np.ndarray]  # for training
    test: np.ndarray
    scale: np.ndarray  # (50,) weights of the angles in SC: 1 / deviation in training, degrees

    @cached_property
    def mean(self) -> np.ndarray:
        """The mean of all training rows."""
        return np.concatenate(self.takes).mean(axis=0)

    @cached_property
    def deviation(self) -> np.ndarray:
        """The standard deviation of all training rows, with n - 1."""
        return np.concatenate(self.takes).std(axis=0, ddof=1)

    @cached_property
    def standardised(self) -> list[np.ndarray]:
        """The training takes, standardised."""
        return [(take - self.mean) / self.deviation for take in self.takes]

    def errors(self, fill: Fill, columns: list[int]) -> np.ndarray:
        """SC and the root mean square error in degrees of the test take's hidden values.

        SC = Σ (degrees · scale of the column)² / H is a sum over rows and H columns.
        """
        take = (self.test - self.mean) / self.deviation
        damaged = take.copy()
        damaged[FIRST_HIDDEN:, columns] = np.nan
        gap = (fill(damaged, FIRST_HIDDEN) - take[:, columns])[FIRST_HIDDEN:]
        degrees = np.rad2deg(gap * self.deviation[columns])
        weighted = np.square(degrees * self.scale[columns])
        return np.array([len(gap) * weighted.mean(), np.sqrt(np.square(degrees).mean())])


def rows_of(frames: np.ndarray) -> np.ndarray:
    """The protocol's rows (F - 1, 59) of the frames (F, 62) of an Acclaim file.

    Angles in degrees, wrapped as asin(sin θ); of the root its steps over the floor and its height,
    sine and cosine of two angles, and the steps of those of the third.
    """
    before = frames[:-1]
    after = frames[1:]
    angles = np.arcsin(np.sin(np.deg2rad(after[:, ANGLES])))
    steps = before[:, [0, 2]] - after[:, [0, 2]]
    parts = [angles, steps, after[:, 1:2]]
    for function in (np.sin, np.cos):
        turns_before = function(np.deg2rad(before[:, 3:6]))
        turns_after = function(np.deg2rad(after[:, 3:6]))
        parts += [turns_after[:, [0, 2]], turns_before[:, 1:2] - turns_after[:, 1:2]]
    return np.concatenate(parts, axis=1)


def read_protocol(folders: Sequence[str | Path]) -> Protocol:
    """Read `walk_jog_30hz.npz` below one of the folders, or the Acclaim files of subject 35.

    Raises ValueError if neither is there, takes are missing, or the table is damaged;
    MotionFileError if an Acclaim file is damaged.
    """
    tables = _find(folders, "walk_jog_30hz.npz")
    if tables:
        frames = _read_table(tables[0])
    else:
        files = {path.stem: path for path in _find(folders, "35_*.amc")}
        names = {n: f"35_{n:02d}" for n in (*TRAINING, TEST)}
        missing = [name for name in names.values() if name not in files]
        if missing:
            raise ValueError(
                "the data folders lack the takes " + ", ".join(missing) + " of CMU subject 35: get "
                "them by `numpy-cae download cmu --subjects 35`"
            )
        frames = {n: amc_values(files[name])[::STEP] for n, name in names.items()}
    angles = np.concatenate([frames[n][:, ANGLES] for n in TRAINING])
    takes = [rows_of(frames[n]) for n in TRAINING]
    return Protocol(takes, rows_of(frames[TEST]), 1 / angles.std(axis=0))


def _read_table(path: Path) -> dict[int, np.ndarray]:
    arrays = load_arrays(path, "the protocol's table")
    names = {n: f"train_35_{n:02d}" for n in TRAINING} | {TEST: f"test_35_{TEST}"}
    if missing := [name for name in names.values() if name not in arrays]:
        raise ValueError(f"{path}: not the protocol's table: it has no {', '.join(missing)}")
    return {n: arrays[name] for n, name in names.items()}


def _find(folders: Sequence[str | Path], pattern: str) -> list[Path]:
    paths = []
    for folder in folders:
        paths += sorted(Path(folder).rglob(pattern))
    return paths


OFFSET = 0.5
"""The variance of a take's constant error, relative to that of its varying error."""
MEMORY = 10
"""The number of rows in which the correlation of the varying error falls by e."""


def add_residual(fill: Fill, columns: list[int]) -> Fill:
    """Predict the error of a fill in the hole from its error in the rows before the hole.

    The error is modelled as a Gaussian process over time. It is the sum of a constant of the take
    (posture), a part that fades within `MEMORY` rows (so that the hole begins without a jump), and
    noise of the variance of this part. With r the errors in the rows T before the hole,

        e_t = k(t, T) (k(T, T) + I)⁻¹ r,    k(d) = OFFSET + exp(-|d| / MEMORY)
    """

    def fill_and_correct(take: np.ndarray, first: int) -> np.ndarray:
        values = fill(take, first)
        error = take[:first, columns] - values[:first]
        rows = np.arange(len(take))
        covariance = OFFSET + np.exp(-np.abs(rows[:, None] - rows[:first]) / MEMORY)
        return values + covariance @ np.linalg.solve(covariance[:first] + np.eye(first), error)

    return fill_and_correct


def nearest(takes: Sequence[np.ndarray], columns: list[int], spread: np.ndarray) -> Fill:
    """Copy the training row with the nearest visible columns, each multiplied by its `spread`."""
    rows = np.concatenate(takes)
    visible = visible_columns(columns)
    weighted = rows[:, visible] * spread[visible]

    def fill(take: np.ndarray, first: int) -> np.ndarray:
        queries = take[:, visible] * spread[visible]
        chosen = [np.square(weighted - query).sum(axis=1).argmin() for query in queries]
        return rows[chosen][:, columns]

    return fill


def gaussian_process(
    takes: Sequence[np.ndarray], columns: list[int], taps: int, penalty: float, width: float
) -> Fill:
    """The mean of a Gaussian process, with the kernel exp(-d² / (width · number of values)) of the
    distance d of the visible columns of `taps` rows, and `penalty` on its diagonal."""
    seen = np.concatenate([around(take[:, visible_columns(columns)], taps) for take in takes])
    hidden = np.concatenate([take[:, columns] for take in takes])
    mean = hidden.mean(axis=0)

    def kernel(rows: np.ndarray) -> np.ndarray:
        lengths = np.square(rows).sum(axis=1)[:, None] + np.square(seen).sum(axis=1)
        return np.exp(-(lengths - 2 * rows @ seen.T) / (width * seen.shape[1]))

    weights = np.linalg.solve(kernel(seen) + penalty * np.eye(len(seen)), hidden - mean)
    return lambda take, first: (
        kernel(around(take[:, visible_columns(columns)], taps)) @ weights + mean
    )


def around(take: np.ndarray, taps: int) -> np.ndarray:
    """Concatenate the `taps` rows around each row, with end rows repeated.

    (F, C) to (F, taps · C).
    """
    padded = np.pad(take, ((taps // 2, taps // 2), (0, 0)), mode="edge")
    return np.concatenate([padded[k : k + len(take)] for k in range(taps)], axis=1)


def visible_columns(columns: list[int]) -> list[int]:
    """The visible columns."""
    return [column for column in range(59) if column not in columns]
