"""Measures of sets of clips, (N, F, C), by the distance

    d(a, b) = √ mean_{t,k} (a_{t,k} - b_{t,k})²

over frames and standardised numbers, so that 1 is one standard deviation in each.
"""

import numpy as np


def clip_distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """d between every clip of a (N, F, C) and every clip of b (M, F, C), as (N, M) float64."""
    a, b = (np.asarray(x, dtype=np.float64).reshape(len(x), -1) for x in (a, b))
    squares = np.sum(a * a, axis=1)[:, None] + np.sum(b * b, axis=1) - 2 * a @ b.T
    return np.sqrt(np.maximum(squares, 0) / a.shape[1])


def nearest_distance(clips: np.ndarray, others: np.ndarray) -> float:
    """The mean over the clips of the distance to the nearest of the others."""
    return float(clip_distances(clips, others).min(axis=1).mean())


def diversity(clips: np.ndarray) -> float:
    """The mean distance between two different clips of a set; 0 if all are the same."""
    distances = clip_distances(clips, clips)
    return float(distances[np.triu_indices(len(clips), 1)].mean())


def nearest_neighbour_accuracy(real: np.ndarray, samples: np.ndarray) -> float:
    """Whether samples can be told from as many real clips: the 1-nearest-neighbour two-sample test.

    Each clip is classified as its nearest neighbour. If both sets have one distribution, half of
    the classes are right; more, if they differ; less, if samples are copies of real clips.

    Lopez-Paz and Oquab, "Revisiting classifier two-sample tests", ICLR 2017; as 1-NN in Xu et al.
    (2018).
    """
    together = np.concatenate([real, samples])
    is_real = np.arange(len(together)) < len(real)
    distances = clip_distances(together, together)
    np.fill_diagonal(distances, np.inf)
    return float(np.mean(is_real[distances.argmin(axis=1)] == is_real))
