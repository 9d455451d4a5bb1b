"""Figure 3 of jang2018: motions sampled from the manifold of one action.

The poster samples "from trained multinomial motion manifold distribution". We read this as a
multivariate normal distribution, fitted to the latent vectors of the training clips; if the
regulariser succeeds, it equals the prior. Samples of both are drawn.
"""

import numpy as np

from numpy_cae.experiments.result import Animation, Result
from numpy_cae.experiments.sequences.study import CLIPS, Study
from numpy_cae.motion.joints import PARENTS
from numpy_cae.viz import PLAIN, PROJECTED, TRUTH, Actor, strip_figure

SAMPLES = 16
"""Samples of an action in the paper."""
STRIP_ROWS, GIF_COLUMNS = 3, 4
FITTED, PRIOR, REAL = "fitted", "prior", "real"
COLOURS = {FITTED: PROJECTED, PRIOR: PLAIN, REAL: TRUTH}


def fitted_latents(study: Study, count: int, seed: int) -> np.ndarray:
    """Draws (count, D) from the normal distribution fitted to the encoded training clips."""
    z = study.manifold.network.encode(study.random_clips(CLIPS, seed)).astype(np.float64)
    rng = np.random.default_rng([seed, 1])
    drawn = rng.multivariate_normal(z.mean(axis=0), np.cov(z, rowvar=False), count)
    return drawn.astype(study.manifold.network.weights["state_w"].dtype)


def sample_clips(study: Study, source: str, count: int, seed: int) -> np.ndarray:
    """Normalised clips (count, F, 54) from FITTED or PRIOR, or REAL ones of the test motions."""
    network, frames = study.manifold.network, study.manifold.frames
    if source == FITTED:
        return network.decode(fitted_latents(study, count, seed), frames)
    if source == PRIOR:
        return network.sample(count, np.random.default_rng([seed, 2]), frames)
    return study.random_clips(count, seed, training=False)


def figure_3(study: Study, seed: int = 0, source: str = FITTED) -> Result:
    """Draw the first of sixteen clips from one source, as strips; FITTED ones also moving."""
    clips = sample_clips(study, source, SAMPLES, seed)[:GIF_COLUMNS]
    actors = [
        Actor(study.positions(clip), PARENTS, f"{source} {number}", COLOURS[source])
        for number, clip in enumerate(clips, start=1)
    ]
    rate = study.manifold.rate
    return Result(
        f"Figure 3 of jang2018: samples of {study.action.name.replace('_', ' ')}, {source}",
        [],
        figure=lambda: strip_figure(actors[:STRIP_ROWS], rate),
        animation=Animation(actors, rate) if source == FITTED else None,
    )
