"""Samples of jang2018's manifolds: `figure_3` draws samples, `samples` measures them in a table.

The poster samples "from trained multinomial motion manifold distribution". We take this to be a
multivariate normal distribution, fitted to the latent vectors of the training clips. If the
regulariser succeeds, this distribution equals the prior. Samples of both are drawn and measured.

near           mean distance to the nearest held-out clip, relative to that of training clips
distinguished  accuracy of a 1-nearest-neighbour two-sample test against held-out clips; 50% is
               perfect
diversity      mean distance between two samples, relative to that between two held-out clips
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation.samples import diversity, nearest_distance, nearest_neighbour_accuracy
from numpy_cae.evaluation.table import Table
from numpy_cae.motion.joints import PARENTS
from numpy_cae.viz import PLAIN, PROJECTED, TRUTH, Actor, strip_figure
from studies.jang2018.training import CLIPS, Study
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
    rows = [row for study in studies for row in _rows(study, seed)]
    caption = "Samples compared with test clips:"
    table = Table(caption, HEADER, rows, ("", ".2f", ".0%", ".2f"))
    actions = [study.action for study in studies]
    claims = []
    alike, other = (
        [table.value(f"{a.name}: {FITTED}", "diversity") for a in actions if a.periodic == periodic]
        for periodic in (True, False)
    )
    if alike and other:
        others = ", ".join(f"{value:.2f}" for value in other)
        figures = f"{max(alike):.2f} for the periodic action, {others} for the others."
        claims.append(Claim("samples_vary", max(alike) < min(other), figures))
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
