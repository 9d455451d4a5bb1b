"""Half of all values set to zero, then repaired: holden2015, section 7 and figure 1, left.

`train` and `demo` print this table. Everything is measured on normalised windows of test takes, so
zero is the mean pose. The error is the root mean square of a coordinate of the 60 position
features, in centimetres; padded frames do not count.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from numpy_cae.baselines import PCA
from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.training import zero_values

P = 0.5
"""The probability with which a value is lost."""
SIZES = (1, 2, 3, 5, 7, 10, 15, 20, 30, 45, 63, 100, 150, 200, 300, 450, 700, 1000)
HEADER = ("method", "reconstruction, cm", "half zeroed, cm", "of corrupted", "size used")


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Compare the network with no repair, the mean pose and PCA; values are lost by the seed.

    The network is measured once, and as the mean over all shifts of its pooling grid. PCA has its
    best size for each column, chosen on the test windows themselves, which favours it.
    """
    seen = clips_of(manifold, [take.positions for take in material.training]).x
    held_out = clips_of(manifold, [take.positions for take in material.testing])
    truth, error = held_out.x, held_out.error
    lost = zero_values(truth, P, np.random.default_rng(seed))
    length, features = truth.shape[1:]
    corrupted = error(lost)

    def network(name: str, shifts: int) -> list:
        whole, repaired = (manifold.project_windows(x, shifts) for x in (truth, lost))
        return [name, error(whole), error(repaired), None]

    rows = [
        ["doing nothing", error(truth), corrupted, None],
        ["the mean pose", error(0 * truth), error(0 * truth), None],
        _pca("PCA on frames", seen, truth, lost, error, features),
        _pca("PCA on windows", seen, truth, lost, error, length * features),
        network("the network", 1),
        network("the network, all shifts", manifold.shifts),
    ]
    rows = [[name, *errors, errors[1] / corrupted, size] for name, *errors, size in rows]
    sample = f"{len(material.testing)} test takes, {len(truth)} windows:"
    return Result("Repair: half of all values set to zero", [Table(sample, HEADER, rows)])


def _pca(
    name: str,
    seen: np.ndarray,
    truth: np.ndarray,
    lost: np.ndarray,
    error: Callable[[np.ndarray], float],
    numbers: int,
) -> list:
    """PCA of rows of so many numbers, at the best of `SIZES` (or all axes) for each column."""
    pca = PCA.fit(seen.reshape(-1, numbers).astype(np.float64))
    largest = len(pca.axes)
    sizes = [size for size in SIZES if size < largest] + [largest]

    def best(x: np.ndarray) -> tuple[float, int]:
        rows = x.reshape(-1, numbers)
        return min((error(pca.project(rows, size).reshape(x.shape)), size) for size in sizes)

    (reconstruction, whole), (repair, few) = best(truth), best(lost)
    return [name, reconstruction, repair, f"{whole}; {few}"]
