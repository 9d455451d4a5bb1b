"""Figure 3 of jang2018: motions sampled from the manifold of one action.

The poster samples "from trained multinomial motion manifold distribution", which can only mean a
multivariate normal one: fitted to the latent vectors of the training clips. If the regulariser
did its work that is the prior itself; both are drawn from here.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.experiments.sequences.study import DRAWS, Study
from numpy_cae.motion import body_positions
from numpy_cae.motion.joints import PARENTS
from numpy_cae.viz import PLAIN, PROJECTED, TRUTH, Actor, save_figure, save_gif, strip_figure

SAMPLES = 16
"""An action in the paper."""
ROWS = 3
"""Of the picture, as in the paper."""
FITTED, PRIOR, REAL = "fitted", "prior", "real"
COLOURS = {FITTED: PROJECTED, PRIOR: PLAIN, REAL: TRUTH}


def fitted_latents(study: Study, count: int, seed: int) -> np.ndarray:
    """Draws (count, D) from the normal distribution fitted to the encoded training clips."""
    z = study.manifold.network.encode(study.drawn(DRAWS, seed)).astype(np.float64)
    rng = np.random.default_rng([seed, 1])
    drawn = rng.multivariate_normal(z.mean(axis=0), np.cov(z, rowvar=False), count)
    return drawn.astype(study.manifold.network.weights["state_w"].dtype)


def sampled(study: Study, count: int, seed: int) -> dict[str, np.ndarray]:
    """Normalised clips (count, F, 54) by where their latent vectors are from."""
    network, frames = study.manifold.network, study.manifold.settings["frames"]
    return {
        FITTED: network.decode(fitted_latents(study, count, seed), frames),
        PRIOR: network.sample(count, np.random.default_rng([seed, 2]), frames),
        REAL: study.drawn(count, seed, training=False),
    }


@dataclass(frozen=True)
class Figure3:
    """Sampled motions of one action, (16, F, 20, 3) positions in metres by where they are from."""

    action: str
    positions: dict[str, np.ndarray]
    rate: float

    @property
    def title(self) -> str:
        """What is seen."""
        return f"Figure 3 of jang2018: {self.action.replace('_', ' ')}, sampled"

    def save_picture(self, path: str | Path, source: str = FITTED) -> None:
        """Strips of the first samples from "fitted", "prior" or "real"."""
        save_figure(strip_figure(self._actors(source, ROWS), self.rate), path)

    def save_gif(self, path: str | Path, source: str = FITTED, count: int = 4) -> None:
        """The first samples, moving side by side."""
        save_gif(self._actors(source, count), path, self.rate, fps=12.5)

    def _actors(self, source: str, count: int) -> list[Actor]:
        return [
            Actor(positions, PARENTS, f"{source} {number + 1}", COLOURS[source])
            for number, positions in enumerate(self.positions[source][:count])
        ]


def figure_3(study: Study, seed: int = 0) -> Figure3:
    """Sixteen samples from the fitted distribution, from the prior, and as many real clips."""
    clips = sampled(study, SAMPLES, seed)
    positions = {
        source: np.stack([body_positions(study.manifold.motion(clip)) for clip in drawn])
        for source, drawn in clips.items()
    }
    return Figure3(study.action.name, positions, study.manifold.rate)
