"""Samples of jang2018's manifolds: `figure_3` draws samples, `samples` measures them in a table.

The poster samples "from trained multinomial motion manifold distribution". We take this to be a
multivariate normal distribution, fitted to the latent vectors of the training clips. If the
regulariser succeeds, this distribution equals the prior. Samples of both are drawn and measured.

near           mean distance to the nearest held-out clip, relative to that of training clips
distinguished  accuracy of a 1-nearest-neighbour two-sample test against held-out clips; 50% is
               perfect
diversity      mean distance between two samples, relative to that between two held-out clips

`regulariser` compares the regulariser of jang2018 with none, λ = 0, and with MMD: do latent vectors
match the prior, at what cost of reconstruction, and what do samples of the prior look like?
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation import diversity, nearest_distance, nearest_neighbour_accuracy
from numpy_cae.evaluation.tables import Table
from numpy_cae.motion.joints import PARENTS
from numpy_cae.viz import PLAIN, PROJECTED, TRUTH, Actor, strip_figure
from studies.jang2018.training import CLIPS, Study, discrepancy
from studies.shared.result import Claim, Picture, Result

SHOWN_IN_PAPER = 16
"""Samples of an action."""
FITTED = "fitted"
PRIOR = "prior"
REAL = "test"
COLOURS = {FITTED: PROJECTED, PRIOR: PLAIN, REAL: TRUTH}
SAMPLES = 100
"""Clips from each source that are measured."""
HEADER = ("samples from", "near", "distinguished", "diversity")


def fitted_latents(study: Study, count: int, seed: int) -> np.ndarray:
    """Draws (count, D) from the normal distribution fitted to the encoded training clips."""
    z = study.manifold.network.encode(study.random_clips(CLIPS, seed)).astype(np.float64)
    rng = np.random.default_rng([seed, 1])
    drawn = rng.multivariate_normal(z.mean(axis=0), np.cov(z, rowvar=False), count)
    return drawn.astype(study.manifold.network.weights["state_w"].dtype)


def sample_clips(study: Study, source: str, count: int, seed: int) -> np.ndarray:
    """Normalised clips (count, F, 54) from FITTED or PRIOR, or REAL ones of the test motions."""
    network = study.manifold.network
    frames = study.manifold.frames
    if source == FITTED:
        return network.decode(fitted_latents(study, count, seed), frames)
    if source == PRIOR:
        return network.sample(count, np.random.default_rng([seed, 2]), frames)
    return study.random_clips(count, seed, training=False)


def figure_3(study: Study, seed: int = 0, source: str = FITTED) -> Picture:
    """Draw sixteen clips from one source as strips; clips from FITTED also move."""
    clips = sample_clips(study, source, SHOWN_IN_PAPER, seed)
    actors = [
        Actor(study.positions(clip), PARENTS, f"{source} {number}", COLOURS[source])
        for number, clip in enumerate(clips, start=1)
    ]
    rate = study.manifold.rate
    shown = actors if source == FITTED else []
    return Picture(lambda: strip_figure(actors, rate), shown, rate)


def samples(studies: Sequence[Study], seed: int = 0) -> Result:
    """Draw clips from each source and study, and measure them."""
    rows: list[list] = []
    for study in studies:
        rows += _rows(study, seed)
    caption = "Samples compared with test clips:"
    table = Table(caption, HEADER, rows, ("", ".2f", ".0%", ".2f"))
    periodic = []
    aperiodic = []
    for study in studies:
        value = table.value(f"{study.action.name}: {FITTED}", "diversity")
        if study.action.periodic:
            periodic.append(value)
        else:
            aperiodic.append(value)
    claims = []
    if periodic and aperiodic:
        listed = ", ".join(f"{value:.2f}" for value in aperiodic)
        figures = f"{max(periodic):.2f} for the periodic action, {listed} for the others."
        claims.append(Claim("samples_vary", max(periodic) < min(aperiodic), figures))
    return Result("Samples of jang2018's manifolds compared with test clips", [table], claims)


def _rows(study: Study, seed: int) -> list[list]:
    held_out = study.random_clips(SAMPLES, seed, training=False)
    training = study.random_clips(SAMPLES, seed + 1)
    real_near = nearest_distance(training, held_out)
    real_diversity = diversity(held_out)
    rows = []
    for source in (FITTED, PRIOR, REAL):
        clips = training if source == REAL else sample_clips(study, source, SAMPLES, seed)
        near = nearest_distance(clips, held_out)
        spread = diversity(clips)
        accuracy = nearest_neighbour_accuracy(held_out, clips)
        measured = near / real_near, accuracy, spread / real_diversity
        rows.append([f"{study.action.name}: {source}", *measured])
    return rows


MAX_DISCREPANCY_RATIO = 2.0
"""The discrepancy may be at most this many times that of two draws of the prior."""
REPEATS = 10
"""Measurements in a mean: a single discrepancy varies by a seventh."""
SLICED = "sliced Wasserstein"
MMD = "MMD"
NONE = "none, λ = 0"
REGULARISERS = ("regulariser", "mean square", "to the prior", "of two draws", "distinguished")


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
        measured = zip(studies, errors[name], distances, ratios[name], strict=True)
        for study, error, distance, ratio in measured:
            sampled = sample_clips(study, PRIOR, SAMPLES, seed)
            real = study.random_clips(SAMPLES, seed, training=False)
            accuracy = nearest_neighbour_accuracy(real, sampled)
            rows.append([f"{study.action.name}: {name}", error, distance, ratio, accuracy])
    caption = f"Regularisers; two draws of the prior are {smallest:.4f} apart:"
    costs = errors[SLICED] / errors[NONE]
    return Result(
        "The Wasserstein regulariser of jang2018, beside MMD and none",
        [Table(caption, REGULARISERS, sorted(rows), ("", ".3f", ".4f", ".1f", ".0%"))],
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
