"""New motion from a prior: holden2015, section 3.

Φ† "always produces" motion "within the subspace of valid human motion", and "the uniform
distribution of values […] drawn from [-1, 1]^(i×k) represents a prior probability distribution
over the space of human motion which can be augmented with other beliefs". Beside the uniform
prior stand a Gaussian of the encoded windows, the first that one would fit, and the one that
`numpy-cae sample` uses.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.baselines import PCA
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.table import text_table
from numpy_cae.manifold import MotionManifold, NeighbourPrior, sample
from numpy_cae.manifold.sample import decode_units, encode_windows
from numpy_cae.measures import Validity, ValidityMeasure
from numpy_cae.motion import PARENTS, POSITIONS, features_to_positions
from numpy_cae.viz import (
    CORRUPTED,
    PLAIN,
    PROJECTED,
    Actor,
    save_figure,
    save_gif,
    strip_figure,
)

DRAWN = 24
"""Motions drawn from each prior."""
AXES = 100
"""Of the Gaussian: they hold more than nine tenths of the variance of the hidden units."""
REAL, PROJECTED_REAL = "test takes", "test takes, projected"
UNIFORM, GAUSSIAN, FITTED = "uniform prior", "Gaussian of windows", "fitted prior"


@dataclass(frozen=True)
class Sampling:
    """Validity of what each prior gives, and some motions of each, as features (F, 63)."""

    rows: dict[str, Validity]
    shown: dict[str, np.ndarray]
    rate: float
    title: str = "Sampling from a prior"

    def text(self) -> str:
        """Each source of motion by its validity."""
        rows = [[name, *row.cells()] for name, row in self.rows.items()]
        table = text_table(["motion", *Validity.HEADER], rows)
        return f"Mean over {DRAWN} motions drawn from each prior:\n\n{table}"

    def findings(self) -> list[Finding]:
        """Whether what the priors give is as valid as what projection gives."""
        return [
            self._finding(
                UNIFORM,
                "The uniform distribution over [-1, 1] represents a prior over the space of human "
                "motion: what the inverse projection makes of it is valid motion (holden2015, "
                "section 3).",
            ),
            self._finding(
                FITTED,
                "The prior can be augmented with other beliefs (holden2015, section 3): fitted to "
                "encoded motion, it gives motion as valid as projected real motion.",
            ),
        ]

    def _finding(self, prior: str, claim: str) -> Finding:
        made, real = self.rows[prior], self.rows[PROJECTED_REAL]
        figures = "; ".join(
            f"{name} {a} against {b}"
            for name, a, b in zip(Validity.HEADER, made.cells(), real.cells(), strict=True)
        )
        held = all(
            getattr(made, name) <= SLACK * getattr(real, name)
            for name in ("bone_length", "foot_sliding", "jitter", "nearest_pose")
        )
        return Finding(
            claim,
            held,
            f"{figures} of the projected test takes. Held means at most {SLACK} times theirs in "
            "bone length, sliding, jitter and nearest pose.",
        )

    def save_picture(self, path: str | Path) -> None:
        """A strip of one motion from each prior, of three from the fitted one."""
        local = {name: x[:, POSITIONS].reshape(len(x), -1, 3) for name, x in self.shown.items()}
        save_figure(strip_figure(_actors(local), self.rate), path)

    def save_gif(self, path: str | Path) -> None:
        """The same, moving."""
        world = {name: features_to_positions(x) for name, x in self.shown.items()}
        save_gif(_actors(world), path, self.rate, seconds=5.0)


SLACK = 1.25
"""How much worse than projected real motion still counts as valid."""


def _actors(motions: dict[str, np.ndarray]) -> list[Actor]:
    colours = {UNIFORM: CORRUPTED, GAUSSIAN: PLAIN}
    return [Actor(x, PARENTS, name, colours.get(name, PROJECTED)) for name, x in motions.items()]


def sampling(manifold: MotionManifold, material: Material, seed: int = 0) -> Sampling:
    """Draw motions from each prior and measure them beside real ones.

    Parameters
    ----------
    manifold : MotionManifold
    material : Material
        The priors are fitted to its training takes.
    seed : int
        Of what is drawn.

    Raises
    ------
    ValueError
        If no training take is as long as a window.
    """
    rng = np.random.default_rng(seed)
    training = [manifold.features(take.positions)[0] for take in material.training]
    testing = [manifold.features(take.positions)[0] for take in material.testing]
    encoded = encode_windows(manifold, training)
    prior, frames = NeighbourPrior(encoded), encoded.shape[1] * manifold.network.frames_per_unit
    drawn = {
        UNIFORM: [sample(manifold, frames, rng) for _ in range(DRAWN)],
        GAUSSIAN: _from_gaussian(manifold, encoded, rng),
        FITTED: [sample(manifold, frames, rng, prior) for _ in range(DRAWN)],
    }
    clips = {REAL: testing, PROJECTED_REAL: [manifold.project(take) for take in testing], **drawn}
    measure = ValidityMeasure(training, manifold.lengths, manifold.rate)
    rows = {name: Validity.mean([measure.of(x) for x in clips[name]]) for name in clips}
    shown = {name: drawn[name][0] for name in (UNIFORM, GAUSSIAN)}
    shown |= {f"{FITTED}, {name}": x for name, x in zip("abc", drawn[FITTED], strict=False)}
    return Sampling(rows, shown, manifold.rate)


def _from_gaussian(
    manifold: MotionManifold, encoded: np.ndarray, rng: np.random.Generator
) -> list[np.ndarray]:
    """Y = m + Σ_i σ_i ε_i u_i, clipped to [-1, 1]: windows as draws from one Gaussian."""
    flat = encoded.reshape(len(encoded), -1).astype(np.float64)
    pca = PCA.fit(flat)
    axes = pca.axes[:AXES]
    spread = ((flat - pca.mean) @ axes.T).std(axis=0)
    drawn = pca.mean + (rng.standard_normal((DRAWN, len(axes))) * spread) @ axes
    y = np.clip(drawn, -1, 1).reshape(DRAWN, *encoded.shape[1:]).astype(encoded.dtype)
    return [decode_units(manifold, one) for one in y]
