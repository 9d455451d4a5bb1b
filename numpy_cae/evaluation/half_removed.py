"""Half of all values removed, then repaired: holden2015, section 7 and figure 1, left.

`train` and `demo` print this table. Each value of the normalised windows of test takes is set to
zero, the value of the mean pose, with probability 1/2. Padded frames do not count.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.evaluation.clips import Clips, clips_of
from numpy_cae.evaluation.pca import PCA
from numpy_cae.evaluation.table import Table
from numpy_cae.manifold import MotionManifold
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
    """Compare the network, also averaged over all shifts of its pooling grid and mixed with the
    manifold's linear map, with no repair, the mean pose and PCA.

    Takes are world positions (F, 20, 3); PCA is fitted to those for training. The seed draws the
    values that are removed. `NOTE` says how the table is read.
    """
    fitted, test = (clips_of(manifold, takes) for takes in (training, testing))
    damaged = zero_values(test.x, P, np.random.default_rng(seed))
    length, features = test.x.shape[1:]

    def row(name: str, used: MotionManifold, average_shifts: bool) -> list:
        both = (test.error(used.project_windows(x, average_shifts)) for x in (test.x, damaged))
        return [name, *both, None]

    alone = replace(manifold, linear=None)
    inputs = {"": damaged}
    if manifold.rescales:  # PCA gets the same information as the network
        inputs[", input divided by 1 - p"] = damaged / (1 - zeroed_fraction(damaged))
    fewer = fitted.evenly(PCA_WINDOWS)
    rows = [
        ["as damaged", test.error(test.x), test.error(damaged), None],
        ["the mean pose", test.error(0 * test.x), test.error(0 * test.x), None],
        *_pca("PCA on frames", fitted.x, test, inputs, features),
        *_pca("PCA on windows", fewer.x, test, inputs, length * features),
        row("the network", alone, average_shifts=False),
        row("the network, averaged over all shifts", alone, average_shifts=True),
    ]
    if manifold.linear is not None:
        rows.append(row("the same, mixed with a linear map", manifold, average_shifts=True))
    rows = [[name, *errors, errors[1] / rows[0][2], size] for name, *errors, size in rows]
    return Table(f"{len(testing)} test takes, {len(test)} windows:", HEADER, rows, best="low")


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
