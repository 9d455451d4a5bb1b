"""Can samples be told from real clips? The 1-nearest-neighbour two-sample test.

Real clips and as many samples are thrown together; each is classed as its nearest neighbour among
all the others is. Where the two are drawn from one distribution half of the classes are right.
More than half: the samples differ. Less: the samples are copies, each real clip's nearest
neighbour being a sample of it.

Lopez-Paz and Oquab, "Revisiting classifier two-sample tests", ICLR 2017; as 1-NN in Xu et al.
(2018).
"""

from __future__ import annotations

import numpy as np

from numpy_cae.measures.clip_distance import clip_distances


def nearest_neighbour_accuracy(real: np.ndarray, samples: np.ndarray) -> float:
    """The share that is classed rightly, 0.5 at best.

    Parameters
    ----------
    real, samples : (N, F, C) arrays of float
        As many of the one as of the other, or the more frequent kind would be nearer by number.

    Raises
    ------
    ValueError
        If their numbers differ.
    """
    if len(real) != len(samples):
        raise ValueError(f"{len(real)} real clips and {len(samples)} samples, expected as many")
    together = np.concatenate([real, samples])
    is_real = np.arange(len(together)) < len(real)
    distances = clip_distances(together, together)
    np.fill_diagonal(distances, np.inf)
    return float(np.mean(is_real[distances.argmin(axis=1)] == is_real))
