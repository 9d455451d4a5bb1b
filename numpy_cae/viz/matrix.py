"""How far motions are from one another: a matrix, ordered by the tree that clusters them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, FigureBase
from scipy.cluster.hierarchy import dendrogram, linkage
from scipy.spatial.distance import squareform

from numpy_cae.viz.colours import PLAIN

# Inches: a cell, the tree, the bar of colours with its numbers, the margin.
_CELL, _TREE, _BAR, _MARGIN = 0.15, 1.6, 0.95, 0.15


def matrix_figure(distances: np.ndarray, names: Sequence[str], unit: str = "distance") -> Figure:
    """A picture of its own; see `draw_matrix`."""
    side = float(np.clip(_CELL * len(names), 2.5, 40.0))
    beside = _TREE + _names_width(side, names) + _BAR + 2 * _MARGIN
    figure = Figure(figsize=(side + beside, side + 2 * _MARGIN))
    draw_matrix(figure, distances, names, unit)
    return figure


def _font_size(side: float, names: Sequence[str]) -> float:
    """Points, so that a name fits into the height of its row."""
    return float(np.clip(0.75 * 72 * side / len(names), 0.5, 9.0))


def _names_width(side: float, names: Sequence[str]) -> float:
    """Inches that the longest name takes, at two thirds of its height a letter."""
    return max(map(len, names), default=0) * 0.62 * _font_size(side, names) / 72 + 0.1


def draw_matrix(
    figure: FigureBase, distances: np.ndarray, names: Sequence[str], unit: str = "distance"
) -> None:
    """A tree of average linkage on the left, the distances in its order, the names on the right.

    Parameters
    ----------
    figure : Figure or SubFigure to draw in
    distances : (N, N) array of float
        Symmetric, zero on the diagonal; at least two motions.
    names : sequence of N str
    unit : str
        What the colours mean, beside their bar.

    Raises
    ------
    ValueError
        If there are fewer than two motions.
    """
    if len(names) < 2:
        raise ValueError(f"a matrix of distances needs two motions, there are {len(names)}")
    tree = linkage(squareform(distances, checks=False), "average", optimal_ordering=True)
    width, height = (size / figure.dpi for size in (figure.bbox.width, figure.bbox.height))
    tall = height - 2 * _MARGIN
    wide = width - _TREE - _names_width(tall, names) - _BAR - 2 * _MARGIN

    def panel(start: float, size: float) -> Axes:
        return figure.add_axes((start / width, _MARGIN / height, size / width, tall / height))

    left, middle = panel(_MARGIN, _TREE - 0.1), panel(_MARGIN + _TREE, wide)
    bar = panel(width - _BAR, 0.15)
    branches = dendrogram(
        tree, ax=left, orientation="left", no_labels=True, color_threshold=0,
        above_threshold_color=PLAIN,
    )  # fmt: skip
    left.invert_yaxis()
    left.axis("off")
    order = branches["leaves"]
    shown = middle.imshow(distances[np.ix_(order, order)], cmap="magma_r", aspect="auto")
    middle.set_xticks([])
    middle.yaxis.tick_right()
    middle.set_yticks(
        range(len(order)), [names[leaf] for leaf in order], fontsize=_font_size(tall, names)
    )
    middle.tick_params(length=0)
    figure.colorbar(shown, cax=bar).set_label(unit, fontsize=8)
    bar.tick_params(labelsize=7)
