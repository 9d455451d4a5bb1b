"""All results of jang2018: the trainings that they need, the tables and the pictures.

Reconstruction compares the network on held-out clips with simpler methods: PCA of whole clips with
as many numbers as z has, the mean pose, and the first frame held. Errors are mean squares of
standardised numbers (the mean pose has about 1) and jang2018's own, the Euclidean distance of a
frame's 51 angles in radians.

The regulariser, λ > 0, is compared with λ = 0: do latent vectors match the prior, and at what cost?
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from scipy.sparse.linalg import svds

from numpy_cae.evaluation import PCA, angle_distance
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.experiments.sequences import study as training
from numpy_cae.experiments.sequences.samples import COLOURS, figure_3, samples
from numpy_cae.experiments.sequences.study import CLIPS, Action, Study, discrepancy
from numpy_cae.manifold import SequenceManifold
from numpy_cae.training import SequenceSchedule, TrainingState

NETWORK, LINEAR, MEAN, HELD = "the network", "PCA", "the mean pose", "the first frame held"
SQUARED, RADIANS = "mean square, standardised", "distance, rad"
PCA_CLIPS = 2500
"""Training clips that PCA is fitted to."""
MAX_DISCREPANCY_RATIO = 2.0
"""The discrepancy may be at most this many times that of two draws of the prior."""
REPEATS = 10
"""Measurements in a mean: a single discrepancy varies by a seventh."""


def sequential(
    actions: Sequence[Action],
    schedule: SequenceSchedule,
    seed: int = 0,
    report: Callable[[str], Callable[[TrainingState], None]] | None = None,
    **network,
) -> tuple[dict[str, Result], dict[str, SequenceManifold]]:
    """Train on each action with the regulariser and without.

    The schedule's weight λ is that of the regulariser; `seed` and `network` are those of
    `train_study`. `report` returns the report of a training from its name. Returns the results by
    the names of their picture files, and the manifolds trained with the regulariser by action.
    """

    def train(action: Action, weight: float) -> Study:
        progress = report(f"{action.name}, λ = {weight:g}") if report else None
        weighted = replace(schedule, weight=weight)
        return training.train_study(action, weighted, seed, progress, **network)

    studies = [train(action, schedule.weight) for action in actions]
    without = [train(action, 0.0) for action in actions]
    results = {
        "figure_2": training.figure_2(studies),
        "reconstruction": reconstruction(studies, seed),
        "samples": samples(studies, seed),
        "regulariser": regulariser(studies, without, seed),
    }
    for study in studies:
        for source in COLOURS:
            results[f"{study.action.name}_{source}"] = figure_3(study, seed, source)
    return results, {study.action.name: study.manifold for study in studies}


def reconstruction(studies: Sequence[Study], seed: int = 0) -> Result:
    """Measure each study's network on its held-out clips; z has one size in all of them.

    The seed chooses the clips that PCA is fitted to.
    """
    latent = studies[0].manifold.network.latent
    rows, claims = [], []
    for study in studies:
        squared = {}
        x = study.held_out()
        reconstructions = {
            NETWORK: study.manifold.network.denoise(x),
            LINEAR: _project_on_pca(study, x, latent, seed),
            MEAN: np.zeros_like(x),
            HELD: np.broadcast_to(x[:, :1], x.shape),
        }
        for method, x_hat in reconstructions.items():
            squared[method] = float(np.mean((x_hat.astype(np.float64) - x) ** 2))
            angles, truth = (study.manifold.denormalise(each) for each in (x_hat, x))
            name = f"{study.action.name}: {method}"
            rows.append([name, squared[method], angle_distance(angles, truth)])
        claims.append(
            Claim(
                f"On {study.action.name} the network reconstructs better than PCA with {latent} "
                "numbers.",
                squared[NETWORK] < squared[LINEAR],
                f"{squared[NETWORK]:.3f} of unit variance, PCA {squared[LINEAR]:.3f}.",
            )
        )
    table = Table("", [f"{latent} numbers a clip", SQUARED, RADIANS], rows, ".3f", "low")
    title = "Reconstruction of held-out clips by jang2018's network and by simpler methods"
    return Result(title, [table], claims)


def _project_on_pca(study: Study, x: np.ndarray, size: int, seed: int) -> np.ndarray:
    """Clips on the first `size` axes of whole clips; all axes would take minutes to compute."""
    rows = study.random_clips(PCA_CLIPS, seed).reshape(PCA_CLIPS, -1).astype(np.float64)
    mean = rows.mean(axis=0)
    _, spread, axes = svds(rows - mean, size, random_state=seed)
    pca = PCA(mean, axes[::-1], spread[::-1] ** 2 / PCA_CLIPS)
    return pca.project(x.astype(np.float64), size)


def regulariser(with_it: Sequence[Study], without: Sequence[Study], seed: int = 0) -> Result:
    """Compare studies of the same actions, trained from one seed with λ above 0 and with λ = 0.

    The seed chooses the clips and draws of the discrepancies.
    """
    manifold = with_it[0].manifold
    smallest = prior_discrepancy(manifold.network.latent, seed)
    rows = []
    for regularised, free in zip(with_it, without, strict=True):
        errors = regularised.squared_error(), free.squared_error()
        distances = _mean_discrepancy(regularised, seed), _mean_discrepancy(free, seed)
        rows.append([regularised.action.name, *errors, *distances, smallest])
    name = f"λ = {manifold.settings['schedule']['weight']:g}"
    header = [name, "mean square", "λ = 0", "to the prior", "λ = 0", "draws of the prior"]
    table = Table("", header, rows, ("", ".3f", ".3f", ".4f", ".4f", ".4f"))
    title = "The Wasserstein regulariser of jang2018: with and without"
    return Result(title, [table], _regulariser_claims(rows))


def _regulariser_claims(rows: Sequence[Sequence]) -> list[Claim]:
    cost = {name: error / free for name, error, free, *_ in rows}
    closeness = {name: z / smallest for name, _, _, z, _, smallest in rows}
    costs, distances = (
        ", ".join(f"{name} {ratio:.{digits}f}" for name, ratio in ratios.items())
        for ratios, digits in ((cost, 2), (closeness, 1))
    )
    return [
        Claim(
            "The regulariser forces the latent vectors to match the prior (jang2018; here: "
            "within twice the distance between two draws of the prior).",
            all(ratio <= MAX_DISCREPANCY_RATIO for ratio in closeness.values()),
            f"{distances} times that distance.",
        ),
        Claim(
            'The regulariser "promotes better reconstruction" (jang2018).',
            all(ratio < 1 for ratio in cost.values()),
            f"Error relative to λ = 0: {costs}.",
        ),
    ]


def prior_discrepancy(latent: int, seed: int = 0) -> float:
    """The mean discrepancy between two draws of the prior: the least that can be expected."""
    rng = np.random.default_rng(seed)
    sizes = REPEATS * [(CLIPS, latent)]
    return float(np.mean([discrepancy(rng.standard_normal(size), rng) for size in sizes]))


def _mean_discrepancy(study: Study, seed: int) -> float:
    """Of `REPEATS` draws of held-out clips."""
    rng = np.random.default_rng(seed)
    draws = [study.random_clips(CLIPS, seed + n, training=False) for n in range(REPEATS)]
    return float(np.mean([discrepancy(study.manifold.network.encode(x), rng) for x in draws]))
