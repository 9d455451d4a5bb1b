"""The solutions of lesson 08, using the manifold."""

import numpy as np


def rescale(x):
    """x / (1 - p̂), p̂ being the share of zeros in each window."""
    zero = x == 0
    counted = ~zero.all(axis=1, keepdims=True)
    lost = (zero & counted).sum(axis=(1, 2), keepdims=True)
    entries = x.shape[1] * counted.sum(axis=(1, 2), keepdims=True)
    p = lost / np.maximum(entries, 1)
    return x / (1 - p).astype(x.dtype)


def complete(x, known, project, interpolate, rounds):
    """Interpolated; in each round the projection, and what it misses, interpolated."""
    completed = interpolate(x, known)
    for _ in range(rounds):
        projected = project(completed)
        missed = interpolate(x - projected, known)
        completed = np.where(known, x, projected + missed)
    return completed


def denoising_weights(second, cross, kept):
    """A of M A = B, the means over all masks that keep a value with one probability."""
    m = kept**2 * second
    np.fill_diagonal(m, kept * np.diag(second))
    return np.linalg.solve(m, kept * cross)


def G(y_0, y_1):
    """Equation 4: squared differences of the largest and smallest values of each unit."""
    largest = y_0.max(axis=0) - y_1.max(axis=0)
    smallest = y_0.min(axis=0) - y_1.min(axis=0)
    return np.sum(largest**2) + np.sum(smallest**2)


def average_precision(distances, alike):
    """The mean precision at the rank of each motion that is alike."""
    ranked = alike[np.argsort(distances)]
    precision = np.cumsum(ranked) / np.arange(1, len(ranked) + 1)
    return precision[ranked].mean()
