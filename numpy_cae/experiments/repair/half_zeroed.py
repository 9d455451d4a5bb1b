"""Half of all values set to zero, then repaired: holden2015, section 7 and figure 1, left.

Everything is measured on windows of takes that nothing was trained on, in the network's own
terms: zero is the mean pose. The error is that of the 60 position features in centimetres, root
mean square a coordinate; held frames do not count.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.baselines import PCA
from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold
from numpy_cae.training import zero_values

P = 0.5
"""The probability with which a value is lost."""


@dataclass(frozen=True)
class Row:
    """One method: its two errors in cm, and what it used for each."""

    method: str
    reconstruction: float
    repair: float
    note: str = ""


@dataclass(frozen=True)
class HalfZeroed:
    """The table and what it was measured on."""

    rows: list[Row]
    windows: int
    takes: int

    def row(self, method: str) -> Row:
        """The row of a method."""
        return next(row for row in self.rows if row.method == method)

    def text(self) -> str:
        """For a terminal or a README."""
        corrupted = self.row("doing nothing").repair
        header = ["method", "reconstruction, cm", "half zeroed, cm", "of corrupted", "size used"]
        lines = [
            [
                row.method,
                f"{row.reconstruction:.2f}",
                f"{row.repair:.2f}",
                f"{row.repair / corrupted:.2f}",
                row.note,
            ]
            for row in self.rows
        ]
        return text_table(header, lines)


def half_zeroed(
    manifold: MotionManifold,
    training: Sequence[np.ndarray],
    testing: Sequence[np.ndarray],
    seed: int = 0,
) -> HalfZeroed:
    """Measure the network beside doing nothing, the mean pose and PCA.

    The network is measured as it stands and as the mean over all shifts of its pooling grid
    (`manifold.blind.project_shifted`).

    PCA is given its best size for each column, chosen on the test windows themselves, which
    favours it. On frames it reconstructs exactly with all 63 numbers, as any copy does.

    Parameters
    ----------
    manifold : MotionManifold
    training, testing : sequences of (F, 20, 3) arrays of float
        Takes in metres at the manifold's rate: what it was trained on, and what it was not.
    seed : int
        Of the lost values.
    """
    seen, held_out = clips_of(manifold, training).x, clips_of(manifold, testing)
    truth, error = held_out.x, held_out.error
    lost = zero_values(truth, P, np.random.default_rng(seed))
    length, features = truth.shape[1:]
    rows = [
        Row("doing nothing", error(truth), error(lost)),
        Row("the mean pose", error(0 * truth), error(0 * truth)),
        _pca("PCA on frames", seen, truth, lost, error, features),
        _pca("PCA on windows", seen, truth, lost, error, length * features),
        _network("the network", manifold, truth, lost, error, shifts=1),
        _network("the network, all shifts", manifold, truth, lost, error, manifold.shifts),
    ]
    return HalfZeroed(rows, len(truth), len(testing))


def _network(
    method: str,
    manifold: MotionManifold,
    truth: np.ndarray,
    lost: np.ndarray,
    error: Callable[[np.ndarray], float],
    shifts: int,
) -> Row:
    whole, mended = (manifold.project_windows(x, shifts) for x in (truth, lost))
    return Row(method, error(whole), error(mended))


SIZES = (1, 2, 3, 5, 7, 10, 15, 20, 30, 45, 63, 100, 150, 200, 300, 450, 700, 1000)


def _pca(
    method: str,
    seen: np.ndarray,
    truth: np.ndarray,
    lost: np.ndarray,
    error: Callable[[np.ndarray], float],
    numbers: int,
) -> Row:
    """PCA of rows of so many numbers, at the best of `SIZES` (or all axes) for each column."""
    pca = PCA.fit(seen.reshape(-1, numbers).astype(np.float64))
    largest = len(pca.axes)
    sizes = [size for size in SIZES if size < largest] + [largest]

    def best(x: np.ndarray) -> tuple[float, int]:
        rows = x.reshape(-1, numbers)
        return min((error(pca.project(rows, size).reshape(x.shape)), size) for size in sizes)

    (reconstruction, whole), (repair, few) = best(truth), best(lost)
    return Row(method, reconstruction, repair, f"{whole}; {few}")
