"""Simple methods of filling in hidden columns: what they learn from standardised takes."""

from collections.abc import Sequence

import numpy as np

from studies.cmu_protocol.protocol import Fill

OFFSET = 0.5
"""OFFSET: the variance of a take's constant error, relative to that of its varying error."""
MEMORY = 10
"""MEMORY: the number of rows in which the correlation of the varying error falls by e."""


def add_residual(fill: Fill, columns: list[int]) -> Fill:
    """Predict the error of a fill in the hole from its error in the rows before the hole.

    The error is modelled as a Gaussian process over time. It is the sum of a constant of the take
    (posture), a part that fades within `MEMORY` rows (so that the hole begins without a jump), and
    noise.
    """

    def filled(take: np.ndarray, first: int) -> np.ndarray:
        values = fill(take, first)
        error = take[:first, columns] - values[:first]
        rows = np.arange(len(take))
        covariance = OFFSET + np.exp(-np.abs(rows[:, None] - rows[:first]) / MEMORY)
        return values + covariance @ np.linalg.solve(covariance[:first] + np.eye(first), error)

    return filled


def nearest(takes: Sequence[np.ndarray], columns: list[int], spread: np.ndarray) -> Fill:
    """Copy the training row with the nearest visible columns, each multiplied by its `spread`."""
    rows = np.concatenate(takes)
    visible = others(columns)
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
    seen = np.concatenate([around(take[:, others(columns)], taps) for take in takes])
    hidden = np.concatenate([take[:, columns] for take in takes])
    mean = hidden.mean(axis=0)

    def kernel(rows: np.ndarray) -> np.ndarray:
        lengths = np.square(rows).sum(axis=1)[:, None] + np.square(seen).sum(axis=1)
        return np.exp(-(lengths - 2 * rows @ seen.T) / (width * seen.shape[1]))

    weights = np.linalg.solve(kernel(seen) + penalty * np.eye(len(seen)), hidden - mean)
    return lambda take, first: kernel(around(take[:, others(columns)], taps)) @ weights + mean


def around(take: np.ndarray, taps: int) -> np.ndarray:
    """Concatenate the `taps` rows around each row, with end rows repeated.

    (F, C) to (F, taps · C).
    """
    padded = np.pad(take, ((taps // 2, taps // 2), (0, 0)), mode="edge")
    return np.concatenate([padded[k : k + len(take)] for k in range(taps)], axis=1)


def others(columns: list[int]) -> list[int]:
    """The visible columns."""
    return [column for column in range(59) if column not in columns]
