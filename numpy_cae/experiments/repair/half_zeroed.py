"""Half of all values set to zero, then repaired: holden2015, section 7 and figure 1, left.

`train` and `demo` print this table and draw the figure. Everything is measured on normalised
windows of test takes, so zero is the mean pose; padded frames do not count.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation import PCA, position_error
from numpy_cae.experiments.clips import Clips, clips_of
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.experiments.result import Result, Table, moving
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion.features import VELOCITY, features_to_positions
from numpy_cae.training import zero_values
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH

P = 0.5
"""The probability with which a value is lost."""
SIZES = (1, 2, 3, 5, 7, 10, 15, 20, 30, 45, 63, 100, 150, 200, 300, 450, 700, 1000)
PCA_WINDOWS = 2000
"""Windows that PCA on windows is fitted to at most, chosen evenly, to save memory."""
HEADER = ("method", "reconstruction, cm", "half zeroed, cm", "share of damage", "axes of PCA")
NOTE = (
    "Errors are of the pose in the body's own frame, without path and heading. PCA has the number "
    "of axes that is best on the test takes, for each of the two columns."
)


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Compare the network, also as the mean over all shifts of its pooling grid, with no repair,
    the mean pose and PCA; values are lost by the seed."""
    seen = clips_of(manifold, [take.positions for take in material.training])
    held_out = clips_of(manifold, [take.positions for take in material.testing])
    truth, error = held_out.x, held_out.error
    lost = zero_values(truth, P, np.random.default_rng(seed))
    length, features = truth.shape[1:]
    corrupted = error(lost)

    def network(name: str, shifts: int) -> list:
        whole, repaired = (manifold.project_windows(x, shifts) for x in (truth, lost))
        return [name, error(whole), error(repaired), None]

    on_frames = _pca("PCA on frames", seen.x, held_out, lost, features)
    seen = seen.evenly(PCA_WINDOWS)
    rows = [
        ["as damaged", error(truth), corrupted, None],
        ["the mean pose", error(0 * truth), error(0 * truth), None],
        on_frames,
        _pca("PCA on windows", seen.x, held_out, lost, length * features),
        network("the network", 1),
        network("the network, all shifts", manifold.shifts),
    ]
    rows = [[name, *errors, errors[1] / corrupted, size] for name, *errors, size in rows]
    table = Table(f"{len(material.testing)} test takes, {len(truth)} windows:", HEADER, rows)
    return Result("Repair: half of all values set to zero", [table], note=NOTE)


def _pca(name: str, seen: np.ndarray, truth: Clips, lost: np.ndarray, numbers: int) -> list:
    """PCA of rows of so many numbers, at the best of `SIZES` (or all axes) for each column."""
    pca = PCA.fit(seen.reshape(-1, numbers))
    largest = len(pca.axes)
    sizes = [size for size in SIZES if size < largest] + [largest]

    def best(x: np.ndarray) -> tuple[float, int]:
        return min((truth.error(pca.project(x, size)), size) for size in sizes)

    (reconstruction, whole), (repair, few) = best(truth.x), best(lost)
    return [name, reconstruction, repair, f"{whole}; {few}"]


def figure_1(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """The typical test take with half of its values lost, projected, and in truth, drawn."""
    features, _ = manifold.features(typical(manifold, material.testing).positions)
    motions = _half_lost(manifold, features, seed)
    errors = {name: position_error(x, features) for name, x in motions.items()}
    labels = [f"{name}, {errors[name]:.1f} cm off in pose" for name in list(errors)[:2]]
    drawn = zip(motions.values(), (CORRUPTED, PROJECTED, TRUTH), strict=True)
    return Result(
        "Figure 1: half of the values lost",
        [Table("", ["motion", "error, cm"], [[name, error] for name, error in errors.items()])],
        (),
        *moving(dict(zip([*labels, "truth"], drawn, strict=True)), manifold.rate, azimuth=55.0),
    )


def half_lost_positions(
    manifold: MotionManifold, take: np.ndarray, seed: int = 0
) -> dict[str, np.ndarray]:
    """World positions (F, 20, 3) in metres of a take, "corrupted" and "truth", on its own path."""
    features, start = manifold.features(take)
    corrupted = _half_lost(manifold, features, seed)["corrupted"]
    corrupted[:, VELOCITY.start :] = features[:, VELOCITY.start :]
    motions = {"corrupted": corrupted, "truth": features}
    return {name: features_to_positions(x, start) for name, x in motions.items()}


def _half_lost(manifold: MotionManifold, features: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    lost = zero_values(manifold.normalise(features), P, np.random.default_rng(seed))
    corrupted = manifold.denormalise(lost)
    return {"corrupted": corrupted, "projected": manifold.project(corrupted), "truth": features}


def typical(manifold: MotionManifold, takes: Sequence[LabelledTake]) -> LabelledTake:
    """The take whose distance from the mean pose is the median of all."""

    def distance(take: LabelledTake) -> float:
        features, _ = manifold.features(take.positions)
        return position_error(np.broadcast_to(manifold.mean_pose, features.shape), features)

    return sorted(takes, key=distance)[len(takes) // 2]
