"""Curves of losses, one that grows while a loop runs in a notebook, and a matrix of distances."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.training.loop import HELD_OUT

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Curve:
    """One line of a `Chart`.

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


def losses_figure(losses: Mapping[str, Sequence[float]]) -> Figure:
    """Draw what a training measured after each epoch, by name: losses and, in a plot of its own,
    the error on held-out takes."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    plots = {"loss": [name for name in losses if name != HELD_OUT]}
    if HELD_OUT in losses:
        plots[HELD_OUT] = [HELD_OUT]
    row = figure.subplots(1, len(plots), squeeze=False)[0]
    for axes, (unit, names) in zip(row, plots.items(), strict=True):
        for name in names:
            axes.plot(range(1, len(losses[name]) + 1), losses[name], label=name)
        axes.set(xlabel="epoch", ylabel=unit, yscale="log" if unit == "loss" else "linear")
        axes.grid(color="#e4e4e4", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    figure.axes[0].legend(frameon=False, fontsize=8)
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
    distances = distances[np.ix_(order, order)]
    names = [names[int(at)] for at in order]
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


def save_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure as a PNG file, atomically."""
    with atomic_write(path) as temporary:
        figure.savefig(temporary, format="png", dpi=110, facecolor="white")


class LiveCurve:
    """A curve of values over steps, redrawn about once a second.

    Use it as `with LiveCurve("loss") as curve: ...` and call `curve.add(value)` in each step.

    Each point of the curve is the mean of `block` values. The first value displays the drawing
    below the cell; later drawings replace it. Needs IPython.
    """

    def __init__(self, title: str, block: int = 1, seconds: float = 1.0):
        self.title = title
        self.block = block
        self.seconds = seconds
        self.values: list[float] = []
        self._display: Any = None
        self._drawn = -np.inf

    def __enter__(self) -> LiveCurve:
        return self

    def __exit__(self, *_: object) -> None:
        if self.values:
            self._draw()

    def add(self, value: float) -> None:
        """Append a value, and draw if the last drawing is older than `seconds`."""
        self.values.append(float(value))
        if time.monotonic() - self._drawn >= self.seconds:
            self._draw()

    def _draw(self) -> None:
        import matplotlib.pyplot as plt
        from IPython.display import display

        ends = np.arange(0, len(self.values), self.block)
        means = np.add.reduceat(self.values, ends) / np.diff([*ends, len(self.values)])
        figure, axes = plt.subplots(figsize=(7, 2.4))
        axes.plot(np.minimum(ends + self.block, len(self.values)), means)
        axes.set(title=self.title, xlabel="step", yscale="log")
        plt.close(figure)  # displayed here, and not once more at the end of the cell
        if self._display is None:
            self._display = display(figure, display_id=True)
        else:
            self._display.update(figure)
        self._drawn = time.monotonic()
