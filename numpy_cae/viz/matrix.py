"""A matrix of distances between motions, in the order of the tree that clusters them."""

import re
from collections.abc import Sequence
from itertools import groupby

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.cluster.hierarchy import dendrogram, leaves_list, linkage
from scipy.spatial.distance import squareform

from numpy_cae.viz.actor import PLAIN

# Inches: a cell, the tree, the colour bar with its numbers, the margin.
_CELL, _TREE, _BAR, _MARGIN = 0.2, 1.6, 0.95, 0.15
_LABELS = 40
"""Names that are written; of more motions, the groups of neighbours with one name are labelled."""


def matrix_figure(distances: np.ndarray, names: Sequence[str], unit: str = "distance") -> Figure:
    """A tree of average linkage on the left, the distances in its order, the names on the right.

    Of more than 40 motions, the 40 longest runs of neighbours are labelled whose names are the same
    but for a number at the end ("walk_001" and "walk_002": "walk, 2").

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
    tree = linkage(squareform(distances, checks=False), "average", optimal_ordering=True)
    order = leaves_list(tree)
    places, labels = _labels([names[leaf] for leaf in order])
    side = float(np.clip(_CELL * len(names), 2.5, 9.0))
    names_width = max(map(len, labels)) * 0.085 + 0.2
    width = side + _TREE + names_width + _BAR + 2 * _MARGIN
    height = side + 2 * _MARGIN
    figure = Figure(figsize=(width, height))

    def panel(start: float, inches: float) -> Axes:
        return figure.add_axes((start / width, _MARGIN / height, inches / width, side / height))

    left, middle = panel(_MARGIN, _TREE - 0.1), panel(_MARGIN + _TREE, side)
    bar = panel(width - _BAR, 0.15)
    dendrogram(
        tree, ax=left, orientation="left", no_labels=True, color_threshold=0,
        above_threshold_color=PLAIN,
    )  # fmt: skip
    left.invert_yaxis()
    left.axis("off")
    image = middle.imshow(distances[np.ix_(order, order)], cmap="magma_r", aspect="auto")
    middle.set_xticks([])
    middle.yaxis.tick_right()
    middle.set_yticks(places, labels, fontsize=8)
    middle.tick_params(length=0 if len(labels) == len(names) else 3)
    figure.colorbar(image, cax=bar).set_label(unit, fontsize=8)
    bar.tick_params(labelsize=7)
    return figure


def _labels(names: Sequence[str]) -> tuple[list[float], list[str]]:
    """The rows that are labelled, and their labels."""
    if len(names) <= _LABELS:
        return list(range(len(names))), list(names)
    runs, start = [], 0
    for group, members in groupby(re.sub(r"[\W_]*\d+$", "", name) for name in names):
        count = len(list(members))
        runs.append((count, start, group))
        start += count
    longest = sorted(sorted(runs, reverse=True)[:_LABELS], key=lambda run: run[1])
    spaced: list[tuple[int, int, str]] = []
    for run in longest:
        # Two labels must not overlap.
        if not spaced or _middle(run) - _middle(spaced[-1]) >= len(names) / 60:
            spaced.append(run)
    return [_middle(run) for run in spaced], [
        f"{group}, {count}" if count > 1 else group for count, _, group in spaced
    ]


def _middle(run: tuple[int, int, str]) -> float:
    return run[1] + (run[0] - 1) / 2
