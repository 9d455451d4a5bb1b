"""Retrieval by a distance: average precision.

A query searches a gallery, nearest first. With rel(r) = 1 where the motion at rank r is relevant,
and R of them in the gallery,

    average precision   1/R · Σ_r rel(r) · (rel(1) + … + rel(r)) / r

The mean over all queries is the mean average precision (mAP) of a table.
"""

import numpy as np


def average_precision(distances: np.ndarray, alike: np.ndarray) -> np.ndarray:
    """The precision at the rank of each relevant motion, averaged over those.

    Parameters
    ----------
    distances : (Q, N) array of float
        From each query to each motion of the gallery; infinite for those that are left out.
    alike : (Q, N) array of bool
        The motions that are relevant to each query.

    Returns
    -------
    (Q,) array of float64

    Raises
    ------
    ValueError
        If nothing in the gallery is relevant to one of the queries.
    """
    alike = alike & np.isfinite(distances)
    order = np.argsort(distances, axis=1, kind="stable")
    ranked = np.take_along_axis(alike, order, axis=1)
    found = ranked.sum(axis=1)
    if np.any(found == 0):
        query = int(np.argmin(found))
        raise ValueError(f"nothing in the gallery is like query {query}: it has no precision")
    precision = np.cumsum(ranked, axis=1) / np.arange(1, ranked.shape[1] + 1)
    return np.sum(precision * ranked, axis=1) / found
