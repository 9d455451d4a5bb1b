"""Half of all values removed, then repaired: holden2015, section 7 and figure 1, left.

`train` and `demo` print this table. Each value of the normalised windows of test takes is set to
zero, the value of the mean pose, with probability 1/2. Padded frames do not count.

The zeros show which values were removed. The first methods are given the zeros as they are, as in
the paper; the last ones, whose rows begin with "mask:", use that a value that is zero is missing.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from numpy_cae.evaluation.clips import Clips, clips_of
from numpy_cae.evaluation.pca import PCA
from numpy_cae.evaluation.table import Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.complete import completed, interpolated
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.training import zero_values

P = 0.5
"""The probability with which a value is removed."""
PCA_WINDOWS = 2000
"""PCA on windows is fitted to at most this many windows, evenly spaced, to save memory."""
HEADER = ("method", "reconstruction, cm", "half of the values removed, cm", "share", "axes of PCA")
NOTE = (
    "Errors are of the pose in the body's own frame, without path and heading. The share is "
    "what is left of the damage. For PCA the best number of axes on the test takes is shown, for "
    "each of the two columns, which favours PCA."
)


def half_removed(
    manifold: MotionManifold,
    training: Sequence[np.ndarray],
    testing: Sequence[np.ndarray],
    seed: int = 0,
) -> Table:
    """Compare the network, also averaged over all shifts of its pooling grid, with no repair, the
    mean pose and PCA; and the completion by the manifold with curves through what is left.

    Takes are world positions (F, 20, 3); PCA is fitted to those for training. The seed draws the
    values that are removed. `NOTE` says how the table is read.
    """
    fitted, test = (clips_of(manifold, takes) for takes in (training, testing))
    damaged = zero_values(test.x, P, np.random.default_rng(seed))
    length, features = test.x.shape[1:]

    def row(name: str, average_shifts: bool) -> list:
        both = (test.error(manifold.project_windows(x, average_shifts)) for x in (test.x, damaged))
        return [name, *both, None]

    inputs = {"": damaged}
    if manifold.rescales:  # PCA gets the same information as the network
        inputs[", input divided by 1 - p"] = damaged / (1 - zeroed_fraction(damaged))
    mean = test.error(0 * test.x)
    rows = [
        ["as damaged", 0.0, test.error(damaged), None],
        ["the mean pose", mean, mean, None],
        *_pca("PCA on frames", fitted.x, test, inputs, features),
        *_pca("PCA on windows", fitted.evenly(PCA_WINDOWS).x, test, inputs, length * features),
        row("the network", average_shifts=False),
        row("the network, averaged over all shifts", average_shifts=True),
        *([name, 0.0, test.error(x), None] for name, x in mask_given(manifold, damaged)),
    ]
    rows = [[name, *errors, errors[1] / rows[0][2], size] for name, *errors, size in rows]
    return Table(f"{len(testing)} test takes, {len(test)} windows:", HEADER, rows, best="low")


def mask_given(manifold: MotionManifold, damaged: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """The name and the result of each method that is given which values are missing."""
    known = damaged != 0
    lines = interpolated(damaged, known)
    yield "mask: linear interpolation", lines
    yield "mask: monotone cubic (PCHIP)", pchip_windows(damaged, known)

    def project(x: np.ndarray) -> np.ndarray:
        return manifold.project_windows(x, average_shifts=True)

    yield "mask: completed by the manifold", completed(damaged, known, lines, project, interpolated)


def pchip_windows(x: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Windows (N, T, C) interpolated over time by PCHIP through the values of a mask; before the
    first and after the last of them the value is repeated, and a column with less than two is
    interpolated linearly."""
    from scipy.interpolate import PchipInterpolator  # slow to import

    filled = interpolated(x, known)
    frames = np.arange(x.shape[1])
    for window, column in np.argwhere(known.sum(axis=1) > 1):
        keys = np.flatnonzero(known[window, :, column])
        curve = PchipInterpolator(keys, x[window, keys, column])
        filled[window, :, column] = curve(np.clip(frames, keys[0], keys[-1]))
    return filled


def _pca(
    name: str, x: np.ndarray, test: Clips, inputs: dict[str, np.ndarray], numbers: int
) -> list[list]:
    """A row for each input of PCA, fitted to x in rows of this many numbers, at the best number
    of axes for each column."""
    pca = PCA.fit(x.reshape(-1, numbers))

    def best(x: np.ndarray) -> tuple[float, int]:
        return min((test.error(pca.project(x, size)), size) for size in pca.sizes)

    reconstruction, size = best(test.x)
    repairs = {name + kind: best(damaged) for kind, damaged in inputs.items()}
    return [
        [kind, reconstruction, repair, f"{size}; {repair_size}"]
        for kind, (repair, repair_size) in repairs.items()
    ]
