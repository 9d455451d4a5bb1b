"""The solutions of lesson 11, matching distributions."""

import numpy as np

from numpy_cae.course.solutions.lesson_10 import read_clips, write_clips
from numpy_cae.ops import mean_squared_error, sliced_wasserstein


def wasserstein_1d(p, q):
    """The squared 2-Wasserstein distance of two sets of numbers; and its pullback."""
    order = np.argsort(p)
    gap = p[order] - np.sort(q)

    def pullback(dloss=1.0):
        dp = np.empty_like(gap)
        dp[order] = (2 * float(dloss) / len(gap)) * gap
        return dp

    return np.mean(gap * gap), pullback


def unit_rows(drawn):
    """Each row divided by its length."""
    return drawn / np.sqrt(np.sum(drawn * drawn, axis=1, keepdims=True))


def regularised_loss(weights, x, prior, directions, weight):
    """Reconstruction + λ · discrepancy, and its gradients by name."""
    z, read_back = read_clips(weights, x)
    x_hat, write_back = write_clips(weights, z, x.shape[1])
    error, error_back = mean_squared_error(x_hat, x)
    discrepancy, discrepancy_back = sliced_wasserstein(z, prior, directions)

    dz, of_writing = write_back(error_back())
    of_reading = read_back(dz + discrepancy_back(weight))
    return error + weight * discrepancy, {**of_reading, **of_writing}
