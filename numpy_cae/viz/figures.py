"""Matplotlib's figures: a strip of poses of a motion, curves of losses, a matrix of distances.

A strip shows poses side by side, seen by an orthographic camera.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.training.state import HELD_OUT
from numpy_cae.viz.actor import Actor
from numpy_cae.viz.colours import curve_styles

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def strip_figure(actors: list[Actor], rate: float, poses: int = 9, azimuth: float = 40.0) -> Figure:
    """A row of poses for each motion, at the same moments in every row.

    The poses are evenly spaced in time and on the strip; the path in the world is left out.

    Parameters
    ----------
    actors : list of Actor, of the same number of frames
    rate : float
        Frames a second, for the times below.
    poses : int
        Number of poses in a row.
    azimuth : float
        Direction of the camera in degrees, 0 in front of a body that faces +Z.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

    moments = _choose_evenly(np.arange(len(actors[0].positions)), poses)
    strip = _lay_out(actors, moments, azimuth)
    top = strip.top
    width = 1.25 * len(moments)
    if any(actor.label for actor in actors):  # 0.22 inches for the line above the poses
        top += 0.22 * (strip.end - strip.start) / width
    height = width * (top - strip.bottom) / (strip.end - strip.start)
    figure = Figure(figsize=(width, len(actors) * height))
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    for row, (actor, row_poses) in enumerate(zip(actors, strip.rows, strict=True)):
        axes = figure.add_subplot(len(actors), 1, row + 1)
        for place, lines in enumerate(row_poses):
            style: dict[str, Any] = {"linewidths": 2.2, "capstyle": "round"}
            axes.add_collection(LineCollection(list(lines), colors=actor.colour, **style))
            time = f"{moments[place] / rate:.1f} s"
            below = (place * strip.spacing, strip.bottom)
            axes.annotate(time, below, ha="center", va="bottom", fontsize=7)
        if actor.label:
            name: dict[str, Any] = {"fontsize": 10, "color": actor.colour, "weight": "bold"}
            axes.text(0.004, 0.99, actor.label, transform=axes.transAxes, va="top", **name)
        axes.set(xlim=(strip.start, strip.end), ylim=(strip.bottom, top))
        axes.axis("off")
    return figure


def strip_svg(actors: list[Actor], frames: np.ndarray, poses: int = 7) -> str:
    """A small strip for a page: poses of some frames, the motions over one another."""
    if not len(frames):
        return ""
    strip = _lay_out(actors, _choose_evenly(frames, poses), 40.0)
    scale = 64 / (strip.top - strip.bottom)  # pixels a metre
    paths = ""
    for actor, row_poses in zip(actors, strip.rows, strict=True):
        ends = (np.concatenate(row_poses) - [strip.start, strip.top]) * [scale, -scale]
        path = "".join(f"M{x:.1f} {y:.1f}L{u:.1f} {v:.1f}" for (x, y), (u, v) in ends)
        paths += f'<path d="{path}" stroke="{actor.colour}"/>'
    width = (strip.end - strip.start) * scale
    return f'<svg viewBox="0 0 {width:.0f} 64" aria-hidden="true">{paths}</svg>'


class _Strip(NamedTuple):
    """Poses side by side, in metres to the right and up.

    Parameters
    ----------
    rows : list of list of (bones, 2, 2) arrays
        For each motion the lines of each of its poses.
    start, end, bottom, top : float
        What the poses cover.
    spacing : float
        The distance of two poses.
    """

    rows: list[list[np.ndarray]]
    start: float
    end: float
    bottom: float
    top: float
    spacing: float


def _choose_evenly(frames: np.ndarray, number: int) -> np.ndarray:
    return frames[np.unique(np.linspace(0, len(frames) - 1, number).round().astype(int))]


def _lay_out(actors: list[Actor], moments: np.ndarray, azimuth: float) -> _Strip:
    """The poses of each motion at some moments, side by side."""
    poses = []
    for actor in actors:
        poses.append([_draw_pose(actor, frame, azimuth) for frame in moments])
    points = np.concatenate([pose.reshape(-1, 2) for pose in chain.from_iterable(poses)])
    spacing = 1.12 * max(np.ptp(points[:, 0]), 0.5)
    # A pose may extend far to one side of its middle (a press-up).
    start = min(-0.55 * spacing, points[:, 0].min() - 0.05)
    end = max(0.55 * spacing, points[:, 0].max() + 0.05) + (len(moments) - 1) * spacing
    bottom = points[:, 1].min() - 0.12
    # Damage can move a body up by any distance.
    top = min(points[:, 1].max() + 0.15, bottom + 3.0 * (end - start))
    rows = []
    for row_poses in poses:
        row = [pose + [place * spacing, 0.0] for place, pose in enumerate(row_poses)]
        rows.append(row)
    return _Strip(rows, start, end, bottom, top, spacing)


def _draw_pose(actor: Actor, frame: int, azimuth: float) -> np.ndarray:
    """The lines of a pose, (bones, 2, 2), with the middle of the body at 0."""
    points = actor.positions[frame]
    on_floor = np.median(points, axis=0) * [1.0, 0.0, 1.0]  # below the middle of the body
    return bones(camera_view(points - on_floor, azimuth), actor.parents)


def camera_view(points: np.ndarray, azimuth: float = 30.0, elevation: float = 8.0) -> np.ndarray:
    """Project points to the picture of an orthographic camera that looks at the origin.

    Parameters
    ----------
    points : (…, 3) array of float
        Y up.
    azimuth : float
        Degrees about Y from which the camera looks: 0 sees a body that faces +Z from the front.
    elevation : float
        Degrees above the horizon.

    Returns
    -------
    (…, 2) array of float64
        To the right and up, in the unit of the points.
    """
    a, e = np.radians([azimuth, elevation])
    right = np.array([np.cos(a), 0.0, -np.sin(a)])
    up = np.array([-np.sin(e) * np.sin(a), np.cos(e), -np.sin(e) * np.cos(a)])
    return np.stack([points @ right, points @ up], axis=-1)


def bones(points: np.ndarray, parents: tuple[int, ...]) -> np.ndarray:
    """The line from each joint's parent to the joint: (J, D) to (bones, 2, D).

    A root with a single child is a point on the floor, as in Bandai's files, and has no bone.
    """
    on_floor = 0 if parents.count(0) == 1 and len(parents) > 2 else -1
    ends = [joint for joint, parent in enumerate(parents) if parent > on_floor]
    starts = [parents[joint] for joint in ends]
    return np.stack([points[starts], points[ends]], axis=1)


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
        axes.set_prop_cycle(curve_styles())
        for name in names:
            axes.plot(range(1, len(losses[name]) + 1), losses[name], label=name)
        axes.set(xlabel="epoch", ylabel=unit, yscale="log" if unit == "loss" else "linear")
        axes.grid(color="#e4e4e4", linewidth=0.6)
        axes.spines[["top", "right"]].set_visible(False)
    figure.axes[0].legend(frameon=False, fontsize=8)
    return figure


_LABELS = 40
"""Of more motions than this, only as many evenly spaced names are written."""


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
    names = [names[int(index)] for index in order]
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
