"""The regulariser of jang2018 beside none, λ = 0, and beside MMD: do latent vectors match the
prior, at what cost of reconstruction, and what do samples of the prior look like?"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation.samples import nearest_neighbour_accuracy
from numpy_cae.evaluation.table import Table
from studies.jang2018.samples import PRIOR, SAMPLES, sample_clips
from studies.jang2018.training import CLIPS, Study, discrepancy
from studies.shared.result import Claim, Result

MAX_DISCREPANCY_RATIO = 2.0
"""The discrepancy may be at most this many times that of two draws of the prior."""
REPEATS = 10
"""Measurements in a mean: a single discrepancy varies by a seventh."""
SLICED, MMD, NONE = "sliced Wasserstein", "MMD", "none, λ = 0"
HEADER = ("regulariser", "mean square", "to the prior", "of two draws", "distinguished")
FORMATS = ("", ".3f", ".4f", ".1f", ".0%")


def regulariser(trained: dict[str, Sequence[Study]], seed: int = 0) -> Result:
    """Compare studies of the same actions, trained from one seed with each regulariser.

    The seed chooses the clips and draws of the discrepancies, which are sliced Wasserstein
    distances in all rows. "Distinguished" is the accuracy with which samples of the prior are told
    from test clips.
    """
    smallest = prior_discrepancy(trained[SLICED][0].manifold.network.latent, seed)
    rows = []
    errors: dict[str, np.ndarray] = {}
    ratios: dict[str, np.ndarray] = {}
    for name, studies in trained.items():
        distances = [_mean_discrepancy(study, seed) for study in studies]
        errors[name] = np.array([study.squared_error() for study in studies])
        ratios[name] = np.array(distances) / smallest
        each = zip(studies, errors[name], distances, ratios[name], strict=True)
        for study, error, distance, ratio in each:
            sampled = sample_clips(study, PRIOR, SAMPLES, seed)
            real = study.random_clips(SAMPLES, seed, training=False)
            told = nearest_neighbour_accuracy(real, sampled)
            rows.append([f"{study.action.name}: {name}", error, distance, ratio, told])
    caption = f"Regularisers; two draws of the prior are {smallest:.4f} apart:"
    costs = errors[SLICED] / errors[NONE]
    return Result(
        "The Wasserstein regulariser of jang2018, beside MMD and none",
        [Table(caption, HEADER, sorted(rows), FORMATS)],
        [
            Claim(
                "prior_matched",
                bool((ratios[SLICED] <= MAX_DISCREPANCY_RATIO).all()),
                f"{_listed(ratios[SLICED])} times that distance;",
                opponent=f"MMD {_listed(ratios[MMD])}, λ = 0 {_listed(ratios[NONE])}.",
            ),
            Claim(
                "regulariser_promotes",
                bool((costs < 1).all()),
                f"error relative to λ = 0: {_listed(costs, 2)};",
                opponent=f"MMD {_listed(errors[MMD] / errors[NONE], 2)}.",
            ),
        ],
    )


def _listed(values: np.ndarray, digits: int = 1) -> str:
    return ", ".join(f"{value:.{digits}f}" for value in values)


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
