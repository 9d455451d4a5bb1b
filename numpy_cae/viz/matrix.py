"""A matrix of distances between motions, in the order of the tree that clusters them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.cluster.hierarchy import dendrogram, linkage
from scipy.spatial.distance import squareform

from numpy_cae.viz.colours import PLAIN

# Inches: a cell, the tree, the colour bar with its numbers, the margin.
_CELL, _TREE, _BAR, _MARGIN = 0.15, 1.6, 0.95, 0.15


def matrix_figure(distances: np.ndarray, names: Sequence[str], unit: str = "distance") -> Figure:
    """A tree of average linkage on the left, the distances in its order, the names on the right.

    Parameters
    ----------
    distances : (N, N) array of float
        Symmetric, zero on the diagonal; at least two motions.
    names : sequence of N str
    unit : str
        Label of the colour bar.

    Raises
    ------
    ValueError
        If there are fewer than two motions.
    """
    if len(names) < 2:
        raise ValueError(f"a matrix of distances needs two motions, there are {len(names)}")
    side = float(np.clip(_CELL * len(names), 2.5, 40.0))
    size = float(np.clip(0.75 * 72 * side / len(names), 0.5, 9.0))  # points, for the rows' height
    names_width = max(map(len, names)) * 0.62 * size / 72 + 0.1
    width = side + _TREE + names_width + _BAR + 2 * _MARGIN
    height = side + 2 * _MARGIN
    figure = Figure(figsize=(width, height))

    def panel(start: float, inches: float) -> Axes:
        return figure.add_axes((start / width, _MARGIN / height, inches / width, side / height))

    left, middle = panel(_MARGIN, _TREE - 0.1), panel(_MARGIN + _TREE, side)
    bar = panel(width - _BAR, 0.15)
    tree = linkage(squareform(distances, checks=False), "average", optimal_ordering=True)
    branches = dendrogram(
        tree, ax=left, orientation="left", no_labels=True, color_threshold=0,
        above_threshold_color=PLAIN,
    )  # fmt: skip
    left.invert_yaxis()
    left.axis("off")
    order = branches["leaves"]
    image = middle.imshow(distances[np.ix_(order, order)], cmap="magma_r", aspect="auto")
    middle.set_xticks([])
    middle.yaxis.tick_right()
    middle.set_yticks(range(len(order)), [names[leaf] for leaf in order], fontsize=size)
    middle.tick_params(length=0)
    figure.colorbar(image, cax=bar).set_label(unit, fontsize=8)
    bar.tick_params(labelsize=7)
    return figure
