"""Reconstruction of held-out clips by jang2018's network, which `train` prints.

The network is compared with PCA of whole clips with as many numbers as z has, the mean pose, and
the first frame held. Errors are mean squares of standardised numbers (the mean pose has about 1)
and jang2018's own, the Euclidean distance of a frame's 51 angles in radians.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation.baselines import PCA
from numpy_cae.evaluation.measures import angle_distance
from numpy_cae.evaluation.table import Table
from numpy_cae.manifold import SequenceManifold
from numpy_cae.motion import AngleSequence, cut_clips, draw_clips

NETWORK = "the network"
LINEAR = "PCA"
MEAN = "the mean pose"
HELD = "the first frame held"
SQUARED = "mean square, standardised"
PCA_CLIPS = 1500
"""Training clips that PCA is fitted to."""

Takes = Sequence[AngleSequence]


def reconstruction(
    name: str, manifold: SequenceManifold, training: Takes, testing: Takes, seed: int = 0
) -> Table:
    """Measure the manifold of an action on clips of test motions.

    The seed chooses the clips of the training motions that PCA is fitted to.
    """
    latent = manifold.network.latent
    x = manifold.normalise(cut_clips(testing, frames=manifold.frames))
    rng = np.random.default_rng(seed)
    learned = manifold.normalise(draw_clips(training, PCA_CLIPS, rng, manifold.frames))
    reconstructions = {
        NETWORK: manifold.network.denoise(x),
        LINEAR: PCA.fit(learned.reshape(PCA_CLIPS, -1)).project(x, latent),
        MEAN: np.zeros_like(x),
        HELD: np.broadcast_to(x[:, :1], x.shape),
    }
    truth = manifold.denormalise(x)
    rows: list[list[object]] = []
    for method, x_hat in reconstructions.items():
        squared = float(np.mean((x_hat.astype(np.float64) - x) ** 2))
        distance = angle_distance(manifold.denormalise(x_hat), truth)
        rows.append([f"{name}: {method}", squared, distance])
    return Table("", [f"{latent} numbers a clip", SQUARED, "distance, rad"], rows, ".3f")
