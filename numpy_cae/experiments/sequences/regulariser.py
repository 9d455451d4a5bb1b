"""λ = 0 against λ > 0: does the regulariser match the prior, and does it promote reconstruction?

Without it nothing gives the latent vectors a scale, so that theirs are also shown whitened, by the
mean and covariance of the training clips': what a shift and a linear map could do afterwards.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequences.study import (
    DRAWS,
    TURNS,
    Study,
    between_draws_of_the_prior,
    discrepancy,
)
from numpy_cae.experiments.table import text_table

WORSE, FURTHER = 1.15, 2.0
"""How much reconstruction may suffer, and how far latents may be from the prior, as a multiple of
the distance between two draws of the prior itself."""


@dataclass(frozen=True)
class Row:
    """One action with the regulariser and without."""

    action: str
    error: float
    error_without: float
    discrepancy: float
    discrepancy_without: float
    discrepancy_whitened: float


@dataclass(frozen=True)
class Regulariser:
    """The table."""

    rows: list[Row]
    weight: float
    floor: float
    title: str = "The Wasserstein regulariser of jang2018: with and without"

    def text(self) -> str:
        """For a terminal."""
        header = [
            f"λ = {self.weight:g}",
            "mean square",
            "λ = 0",
            "to the prior",
            "λ = 0",
            "λ = 0, whitened",
            "draws of the prior",
        ]
        rows = [
            [
                row.action,
                f"{row.error:.3f}",
                f"{row.error_without:.3f}",
                f"{row.discrepancy:.4f}",
                f"{row.discrepancy_without:.4f}",
                f"{row.discrepancy_whitened:.4f}",
                f"{self.floor:.4f}",
            ]
            for row in self.rows
        ]
        return text_table(header, rows)

    def findings(self) -> list[Finding]:
        """The paper's two claims."""
        closeness = ", ".join(
            f"{row.action} {row.discrepancy / self.floor:.1f}" for row in self.rows
        )
        cost = ", ".join(f"{row.action} {row.error / row.error_without:.2f}" for row in self.rows)
        return [
            Finding(
                "The regulariser forces the latent vectors to match the prior (jang2018; here: "
                "within twice the distance between two draws of the prior).",
                all(row.discrepancy <= FURTHER * self.floor for row in self.rows),
                f"{closeness} times that distance.",
            ),
            Finding(
                'The regulariser "promotes better reconstruction" (jang2018).',
                all(row.error < row.error_without for row in self.rows),
                f"The error is {cost} of what it is without.",
            ),
            Finding(
                "The regulariser costs no more than 15% of reconstruction.",
                all(row.error <= WORSE * row.error_without for row in self.rows),
                f"The error is {cost} of what it is without.",
            ),
        ]


def regulariser(with_it: Sequence[Study], without: Sequence[Study], seed: int = 0) -> Regulariser:
    """Compare studies of the same actions, from the same seed.

    Parameters
    ----------
    with_it, without : sequences of Study
        In the same order; λ is above 0 in the first and 0 in the second.
    seed : int
        Of the draws.
    """
    rows = []
    for one, other in zip(with_it, without, strict=True):
        seen = _latents(other, seed, training=True)
        turns = range(seed, seed + TURNS)
        z, plain = ([_latents(each, turn) for turn in turns] for each in (one, other))
        rows.append(
            Row(
                one.action.name,
                _squared_error(one),
                _squared_error(other),
                _discrepancy(z, seed),
                _discrepancy(plain, seed),
                _discrepancy([_whitened(each, seen) for each in plain], seed),
            )
        )
    first = with_it[0].manifold
    return Regulariser(
        rows,
        first.settings["schedule"]["weight"],
        between_draws_of_the_prior(first.network.latent, seed),
    )


def _latents(study: Study, seed: int, training: bool = False) -> np.ndarray:
    clips = study.drawn(DRAWS, seed, training)
    return study.manifold.network.encode(clips).astype(np.float64)


def _discrepancy(draws: Sequence[np.ndarray], seed: int) -> float:
    """The mean over all draws of clips."""
    rng = np.random.default_rng(seed)
    return float(np.mean([discrepancy(z, rng) for z in draws]))


def _squared_error(study: Study) -> float:
    x = study.held_out()
    return float(np.mean((study.manifold.network.denoise(x) - x) ** 2))


def _whitened(z: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Σ^(-1/2) (z - μ) with μ and Σ of `seen`."""
    values, axes = np.linalg.eigh(np.cov(seen, rowvar=False))
    return (z - seen.mean(axis=0)) @ axes / np.sqrt(values)
