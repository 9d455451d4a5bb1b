"""How well clips that were never seen come back through the sequential autoencoder.

Beside it: PCA of whole clips with as many numbers as z has, the mean pose, and holding the first
frame. Errors are of standardised numbers (mean square, so that the mean pose has about 1) and,
jang2018's own, the Euclidean distance of a frame's 51 angles in radians.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import svds

from numpy_cae.baselines import PCA
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.experiments.table import text_table
from numpy_cae.measures import angle_distance

NETWORK, LINEAR, MEAN, HELD = "the network", "PCA", "the mean pose", "the first frame held"
SEEN = 2500
"""Training clips that PCA is fitted to."""


@dataclass(frozen=True)
class Row:
    """One method on one action's held-out clips."""

    action: str
    method: str
    squared: float
    radians: float


@dataclass(frozen=True)
class SequenceReconstruction:
    """The table."""

    rows: list[Row]
    latent: int
    title: str = "Reconstruction of held-out clips, jang2018's network beside simpler ones"

    def row(self, action: str, method: str) -> Row:
        """One of them."""
        return next(row for row in self.rows if (row.action, row.method) == (action, method))

    def text(self) -> str:
        """For a terminal."""
        rows = [
            [f"{row.action}: {row.method}", f"{row.squared:.3f}", f"{row.radians:.3f}"]
            for row in self.rows
        ]
        header = [f"{self.latent} numbers a clip", "mean square, standardised", "distance, rad"]
        return text_table(header, rows)

    def findings(self) -> list[Finding]:
        """Whether the network beats PCA of its own size, action by action."""
        return [
            Finding(
                f"On {action} the network reconstructs better than PCA with {self.latent} numbers.",
                self.row(action, NETWORK).squared < self.row(action, LINEAR).squared,
                f"{self.row(action, NETWORK).squared:.3f} of unit variance, "
                f"PCA {self.row(action, LINEAR).squared:.3f}.",
            )
            for action in dict.fromkeys(row.action for row in self.rows)
        ]


def reconstruction(studies: Sequence[Study], seed: int = 0) -> SequenceReconstruction:
    """Measure each study's network on its held-out clips.

    Parameters
    ----------
    studies : sequence of Study
        All of one size of z.
    seed : int
        Of the clips that PCA sees.
    """
    rows = []
    for study in studies:
        x = study.held_out()
        for method, x_hat in {
            NETWORK: study.manifold.network.denoise(x),
            LINEAR: _pca(study, x, seed),
            MEAN: np.zeros_like(x),
            HELD: np.broadcast_to(x[:, :1], x.shape),
        }.items():
            squared = float(np.mean((x_hat.astype(np.float64) - x) ** 2))
            radians = angle_distance(
                study.manifold.denormalise(x_hat), study.manifold.denormalise(x)
            )
            rows.append(Row(study.action.name, method, squared, radians))
    return SequenceReconstruction(rows, studies[0].manifold.network.latent)


def _pca(study: Study, x: np.ndarray, seed: int) -> np.ndarray:
    pca = leading_axes(study, study.manifold.network.latent, seed)
    rows = x.reshape(len(x), -1).astype(np.float64)
    return pca.project(rows, len(pca.axes)).reshape(x.shape)


def leading_axes(study: Study, size: int, seed: int) -> PCA:
    """PCA of whole clips, its first axes alone; all `SEEN` would take minutes."""
    seen = study.drawn(SEEN, seed).reshape(SEEN, -1).astype(np.float64)
    mean = seen.mean(axis=0)
    _, spread, axes = svds(seen - mean, size, random_state=seed)
    return PCA(mean, axes[::-1], spread[::-1] ** 2 / SEEN)
