"""The 1-nearest-neighbour two-sample test: whether samples can be told from real clips.

Each of equally many real clips and samples is classified as its nearest neighbour. If both have one
distribution, half of the classes are right; more, if they differ; less, if samples are copies of
real clips.

Lopez-Paz and Oquab, "Revisiting classifier two-sample tests", ICLR 2017; as 1-NN in Xu et al.
(2018).
"""

import numpy as np

from numpy_cae.measures.clip_distance import clip_distances


def nearest_neighbour_accuracy(real: np.ndarray, samples: np.ndarray) -> float:
    """The share of right classes, 0.5 at best.

    Parameters
    ----------
    real, samples : (N, F, C) arrays of float
        Equally many of both.

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
