"""The regulariser of jang2018, λ > 0, compared with λ = 0: do latent vectors match the prior, and
at what cost?"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation.table import Table
from studies.jang2018.training import CLIPS, Study, discrepancy
from studies.shared.result import Claim, Result

MAX_DISCREPANCY_RATIO = 2.0
"""The discrepancy may be at most this many times that of two draws of the prior."""
REPEATS = 10
"""Measurements in a mean: a single discrepancy varies by a seventh."""


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
    table = Table(
        "The regulariser, with and without:", header, rows, ("", ".3f", ".3f", ".4f", ".4f", ".4f")
    )
    title = "The Wasserstein regulariser of jang2018: with and without"
    return Result(title, [table], _regulariser_claims(rows))


def _regulariser_claims(rows: Sequence[Sequence]) -> list[Claim]:
    cost = {name: error / free for name, error, free, *_ in rows}
    closeness = {name: z / smallest for name, _, _, z, _, smallest in rows}
    costs, distances = (
        ", ".join(f"{name} {ratio:.{digits}f}" for name, ratio in ratios.items())
        for ratios, digits in ((cost, 2), (closeness, 1))
    )
    near = all(ratio <= MAX_DISCREPANCY_RATIO for ratio in closeness.values())
    lower = all(ratio < 1 for ratio in cost.values())
    return [
        Claim("prior_matched", near, f"{distances} times that distance."),
        Claim("regulariser_promotes", lower, f"Error relative to λ = 0: {costs}."),
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
