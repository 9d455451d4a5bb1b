"""Half of all values removed, then repaired: holden2015, section 7 and figure 1, left.

`train` and `demo` print this table and draw the figure. Each value of the normalised windows of
test takes is set to zero, the value of the mean pose, with probability 1/2. Padded frames do not
count.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from numpy_cae.evaluation import PCA, position_error
from numpy_cae.experiments.clips import Clips, clips_of
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.result import Result, Table, moving
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.training import zero_values
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH

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


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Compare the network, also averaged over all shifts of its pooling grid and mixed with the
    manifold's linear map, with no repair, the mean pose and PCA.

    The seed draws the values that are removed.
    """
    training = clips_of(manifold, [take.positions for take in material.training])
    testing = clips_of(manifold, [take.positions for take in material.testing])
    truth, error = testing.x, testing.error
    damaged = zero_values(truth, P, np.random.default_rng(seed))
    length, features = truth.shape[1:]
    damage = error(damaged)

    def row(name: str, used: MotionManifold, average_shifts: bool) -> list:
        both = (error(used.project_windows(x, average_shifts)) for x in (truth, damaged))
        return [name, *both, None]

    alone = replace(manifold, linear=None)
    inputs = {"": damaged}
    if manifold.rescales:  # PCA gets the same information as the network
        inputs[", input divided by 1 - p"] = damaged / (1 - zeroed_fraction(damaged))
    fewer = training.evenly(PCA_WINDOWS)
    rows = [
        ["as damaged", error(truth), damage, None],
        ["the mean pose", error(0 * truth), error(0 * truth), None],
        *_pca("PCA on frames", training.x, testing, inputs, features),
        *_pca("PCA on windows", fewer.x, testing, inputs, length * features),
        row("the network", alone, average_shifts=False),
        row("the network, averaged over all shifts", alone, average_shifts=True),
    ]
    if manifold.linear is not None:
        rows.append(row("the same, mixed with a linear map", manifold, average_shifts=True))
    rows = [[name, *errors, errors[1] / damage, size] for name, *errors, size in rows]
    table = Table(
        f"{len(material.testing)} test takes, {len(truth)} windows:", HEADER, rows, best="low"
    )
    return Result("Repair: half of the values removed", [table], note=NOTE)


def _pca(
    name: str, x: np.ndarray, truth: Clips, inputs: dict[str, np.ndarray], numbers: int
) -> list[list]:
    """A row for each input of PCA, fitted to x in rows of this many numbers, at the best number
    of axes for each column."""
    pca = PCA.fit(x.reshape(-1, numbers))

    def best(x: np.ndarray) -> tuple[float, int]:
        return min((truth.error(pca.project(x, size)), size) for size in pca.sizes)

    reconstruction, size = best(truth.x)
    rows = []
    for kind, damaged in inputs.items():
        repair, repair_size = best(damaged)
        rows.append([name + kind, reconstruction, repair, f"{size}; {repair_size}"])
    return rows


def figure_1(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """The typical test take with half of its values removed, projected, and in truth, drawn."""
    features, _ = manifold.features(typical(manifold, material.testing).positions)
    damaged = zero_values(manifold.normalise(features), P, np.random.default_rng(seed))
    corrupted = manifold.denormalise(damaged)
    projected = manifold.project(corrupted)
    motions = {"corrupted": corrupted, "projected": projected, "truth": features}
    errors = {name: position_error(x, features) for name, x in motions.items()}
    labels = [f"{name}, {errors[name]:.1f} cm off in pose" for name in list(errors)[:2]]
    drawn = zip(motions.values(), (CORRUPTED, PROJECTED, TRUTH), strict=True)
    return Result(
        "Figure 1: half of the values removed",
        [Table("", ["motion", "error, cm"], [[name, error] for name, error in errors.items()])],
        (),
        *moving(dict(zip([*labels, "truth"], drawn, strict=True)), manifold.rate, azimuth=55.0),
    )


def typical(manifold: MotionManifold, takes: Sequence[LabelledTake]) -> LabelledTake:
    """The take whose distance from the mean pose is the median of all."""

    def distance(take: LabelledTake) -> float:
        features, _ = manifold.features(take.positions)
        return position_error(np.broadcast_to(manifold.mean_pose, features.shape), features)

    return sorted(takes, key=distance)[len(takes) // 2]
