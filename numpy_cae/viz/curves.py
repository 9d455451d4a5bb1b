"""Curves, and a matrix of distances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Curve:
    """One line of a plot.

    Parameters
    ----------
    x, y : sequences of the same number of float
    label : str
    colour : str, optional
        Matplotlib's next colour if None.
    style : str
        Of Matplotlib, such as "--".
    """

    x: Sequence[float]
    y: Sequence[float]
    label: str
    colour: str | None = None
    style: str = "-"


def curves_figure(
    curves: Sequence[Curve], across: str, up: str, size: tuple[float, float] = (8.0, 4.6)
) -> Figure:
    """Draw curves in one plot with a legend on the right.

    Parameters
    ----------
    curves : sequence of Curve
    across, up : str
        Labels of the axes, with units.
    size : (width, height) in inches
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    axes = figure.add_subplot()
    for curve in curves:
        axes.plot(
            curve.x, curve.y, curve.style, color=curve.colour, label=curve.label, markersize=4
        )
    _finish(axes, across, up)
    figure.legend(loc="outside right upper", frameon=False, fontsize=8)
    return figure


_LABELS = 40
"""LABELS: of more motions than this, only as many evenly spaced names are written."""


def matrix_figure(
    distances: np.ndarray, names: Sequence[str], unit: str = "distance", title: str = ""
) -> Figure:
    """Draw a matrix of distances, near ones dark, with the names of the motions on the right. The
    order is that of a hierarchical clustering, in which similar motions are neighbours.

    Parameters
    ----------
    distances : (N, N) array of float
    names : sequence of N str
    unit : str
        Label of the colour bar.
    title : str
    """
    from matplotlib.figure import Figure
    from scipy.cluster.hierarchy import leaves_list, linkage

    pairs = distances[np.triu_indices(len(names), 1)]
    order = leaves_list(linkage(pairs, "average", optimal_ordering=True))
    distances, names = distances[np.ix_(order, order)], [names[int(at)] for at in order]
    side = float(np.clip(0.2 * len(names), 2.5, 9.0))
    figure = Figure(figsize=(side + 3.0, side), layout="constrained")
    axes = figure.add_subplot()
    image = axes.imshow(distances, cmap="magma")
    axes.set_title(title, fontsize=10)
    rows = np.arange(0, len(names), -(-len(names) // _LABELS))
    axes.set_xticks([])
    axes.yaxis.tick_right()
    axes.set_yticks(rows, [names[int(row)] for row in rows], fontsize=8)
    figure.colorbar(image, label=unit)
    return figure


def _finish(axes, across: str, up: str) -> None:
    axes.set(xlabel=across, ylabel=up)
    axes.grid(color="#e4e4e4", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
