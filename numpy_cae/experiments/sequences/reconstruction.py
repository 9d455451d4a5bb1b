"""Reconstruction error of held-out clips: jang2018's network and simpler methods.

The other methods are PCA of whole clips with as many numbers as z has, the mean pose, and the
first frame held. Errors are mean squares of standardised numbers (the mean pose has about 1) and
jang2018's own, the Euclidean distance of a frame's 51 angles in radians.
"""

from collections.abc import Sequence

import numpy as np
from scipy.sparse.linalg import svds

from numpy_cae.evaluation import PCA, angle_distance
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.experiments.sequences.study import Study

NETWORK, LINEAR, MEAN, HELD = "the network", "PCA", "the mean pose", "the first frame held"
SQUARED, RADIANS = "mean square, standardised", "distance, rad"
PCA_CLIPS = 2500
"""Training clips that PCA is fitted to."""


def reconstruction(studies: Sequence[Study], seed: int = 0) -> Result:
    """Measure each study's network on its held-out clips; z has one size in all of them.

    The seed chooses the clips that PCA is fitted to.
    """
    latent = studies[0].manifold.network.latent
    rows, claims = [], []
    for study in studies:
        squared = {}
        x = study.held_out()
        for method, x_hat in _reconstructions(study, x, seed).items():
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
    table = Table("", [f"{latent} numbers a clip", SQUARED, RADIANS], rows, ".3f")
    title = "Reconstruction of held-out clips by jang2018's network and by simpler methods"
    return Result(title, [table], claims)


def _reconstructions(study: Study, x: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    """Clips x (N, F, 54) by each method."""
    network = study.manifold.network
    return {
        NETWORK: network.denoise(x),
        LINEAR: _project_on_pca(study, x, network.latent, seed),
        MEAN: np.zeros_like(x),
        HELD: np.broadcast_to(x[:, :1], x.shape),
    }


def _project_on_pca(study: Study, x: np.ndarray, size: int, seed: int) -> np.ndarray:
    """Clips on the first `size` axes of whole clips; all axes would take minutes to compute."""
    rows = study.random_clips(PCA_CLIPS, seed).reshape(PCA_CLIPS, -1).astype(np.float64)
    mean = rows.mean(axis=0)
    _, spread, axes = svds(rows - mean, size, random_state=seed)
    pca = PCA(mean, axes[::-1], spread[::-1] ** 2 / PCA_CLIPS)
    return pca.project(x.astype(np.float64), size)
