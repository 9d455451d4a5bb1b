"""Half of all values removed, then repaired: holden2015, section 7 and figure 1, left.

`train` and `demo` print this table. Each value of the normalised windows of test takes is set to
zero, the value of the mean pose, with probability 1/2. Padded frames do not count.

The zeros show which values were removed. The first methods are given the zeros as they are, as in
the paper; the last ones, whose rows begin with "mask:", are given which values are missing.
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from scipy.interpolate import pchip_interpolate

from numpy_cae.evaluation.baselines import PCA, Gaussian, filtered
from numpy_cae.evaluation.clips import Clips, clips_of
from numpy_cae.evaluation.table import Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.complete import interpolated, zeroed_fraction
from numpy_cae.training import zero_values

P = 0.5
"""The probability with which a value is removed."""
FITTED = 2000
"""Baselines are fitted to at most this many windows, evenly spaced, to save memory and time."""
DAMAGED = "as damaged"
PRINCIPAL = "PCA on windows, input / (1 - p)"
LINEAR = "linear map of 15 frames"
NETWORK = "the network"
LINES = "mask: linear interpolation"
PCHIP = "mask: monotone cubic (PCHIP)"
SPLINE = "mask: limited cubic spline"
GAUSSIAN = "mask: Gaussian of 15 frames"
COMPLETED = "mask: completed by the manifold"
SIMPLE = (PRINCIPAL, LINEAR)
SIMPLE_WITH_MASK = (LINES, PCHIP, SPLINE, GAUSSIAN)
"""SIMPLE, SIMPLE_WITH_MASK: the opponents of the network, and of the completion."""
HEADER = ("method", "reconstruction", "half removed", "share")
NOTE = (
    "Errors are of the pose in the body's own frame, without path and heading. The share is "
    "what is left of the damage. PCA has the number of axes that is best for the repair of the "
    "test takes, which favours PCA. PCA, the linear map and the Gaussian are fitted to the "
    'training takes. Rows with "mask:" are given which values are missing.'
)


def half_removed(
    manifold: MotionManifold,
    training: Sequence[np.ndarray],
    testing: Sequence[np.ndarray],
    seed: int = 0,
) -> Table:
    """Compare the network, also averaged over all shifts of its pooling grid, and the completion
    by the manifold with no repair, the mean pose and the baselines.

    Takes are world positions (F, 20, 3); baselines are fitted to those for training. The seed draws
    the values that are removed. `NOTE` says how the table is read.
    """
    fitted, test = (clips_of(manifold, takes) for takes in (training, testing))
    damaged = zero_values(test.x, P, np.random.default_rng(seed))
    before = test.error(damaged)
    rows = []
    for name, undamaged, repaired in Repairs(manifold, fitted).of(test, damaged, P):
        error = test.error(repaired)
        rows.append([name, test.error(undamaged), error, error / before])
    title = f"{len(testing)} test takes, {len(test)} windows, errors in cm:"
    return Table(title, HEADER, rows)


class Repairs:
    """The methods of the table, with baselines fitted to windows of training takes."""

    def __init__(self, manifold: MotionManifold, training: Clips):
        self.manifold = manifold
        fitted = training.evenly(FITTED)
        self.pca = PCA.fit(fitted.x.reshape(len(fitted), -1))
        self.gaussian = Gaussian(fitted.x, fitted.real)

    def of(self, test: Clips, damaged: np.ndarray, p: float) -> Iterator[tuple]:
        """The name of each method, and what it makes of the undamaged windows and of the damaged
        ones, in which zeros, a share p of the values, are missing."""
        x = test.x
        yield DAMAGED, x, damaged
        yield "the mean pose", 0 * x, 0 * x
        divided = damaged / (1 - zeroed_fraction(damaged))
        size = min(self.pca.sizes, key=lambda n: test.error(self.pca.project(divided, n)))
        yield PRINCIPAL, self.pca.project(x, size), self.pca.project(divided, size)
        weights = self.gaussian.linear_map(p)
        yield LINEAR, filtered((1 - p) * x, weights), filtered(damaged, weights)
        for name, shifts in ((NETWORK, False), (f"{NETWORK}, averaged over shifts", True)):
            yield name, *(self.manifold.project_windows(each, shifts) for each in (x, damaged))
        known = damaged != 0
        yield LINES, x, by_column(damaged, known, np.interp)
        yield PCHIP, x, by_column(damaged, known, _pchip)
        yield SPLINE, x, interpolated(damaged, known)
        yield GAUSSIAN, x, self.gaussian.complete(damaged, known)
        yield COMPLETED, x, self.manifold.complete_windows(damaged, known)


def by_column(
    x: np.ndarray,
    known: np.ndarray,
    curve: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray],
) -> np.ndarray:
    """Windows (N, T, C) interpolated over time by curve(frames, known frames, known values), each
    column by itself; before the first and after the last known value this value is repeated, and a
    column without one is zero."""
    filled = np.zeros_like(x)
    frames = np.arange(x.shape[1])
    for window, column in np.argwhere(known.any(axis=1)):
        keys = np.flatnonzero(known[window, :, column])
        inside = frames.clip(keys[0], keys[-1])
        filled[window, :, column] = curve(inside, keys, x[window, keys, column])
    return filled


def _pchip(frames: np.ndarray, keys: np.ndarray, values: np.ndarray) -> np.ndarray:
    return pchip_interpolate(keys, values, frames) if len(keys) > 1 else values
