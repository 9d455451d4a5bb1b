"""A motion as an animated GIF."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.viz.actor import Actor
from numpy_cae.viz.camera import bones, camera_view, floor_point


def save_gif(
    actors: list[Actor],
    path: str | Path,
    rate: float,
    fps: float = 15.0,
    azimuth: float = 40.0,
    seconds: float = 10.0,
) -> None:
    """Write motions side by side as a GIF; a camera follows each of them over a floor.

    Parameters
    ----------
    actors : list of Actor, of the same number of frames
    path : path of the .gif file
    rate : float
        Frames a second of the motions.
    fps : float
        Frames a second of the animation, at most `rate`.
    azimuth : float
        Degrees from which the camera looks.
    seconds : float
        A longer motion is truncated.
    """
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    step = max(1, round(rate / fps))
    moments = range(0, min(len(actors[0].positions), int(seconds * rate)), step)
    half = _half_width(actors, moments, azimuth)
    figure = Figure(figsize=(2.4 * half * len(actors), 2.8))
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    panels = [
        _Panel(figure.add_subplot(1, len(actors), place + 1), actor, azimuth, half)
        for place, actor in enumerate(actors)
    ]

    def draw(frame: int) -> list:
        return [artist for panel in panels for artist in panel.draw(frame)]

    animation = FuncAnimation(figure, draw, frames=moments, blit=False, init_func=lambda: [])
    with atomic_write(path) as beside:
        animation.save(beside, writer=PillowWriter(fps=rate / step), dpi=80)


def _half_width(actors: list[Actor], moments: range, azimuth: float) -> float:
    """Half the width of a panel in metres: more for a body that lies down."""
    shown = [actor.positions[moment] for actor in actors for moment in moments]
    reach = max(
        np.abs(camera_view(points - floor_point(points), azimuth)[:, 0]).max() for points in shown
    )
    return float(np.clip(reach + 0.1, 0.9, 1.6))


class _Panel:
    """The part of the picture with one motion."""

    _TILE = 0.5  # metres between two lines of the floor

    def __init__(self, axes, actor: Actor, azimuth: float, half: float):
        from matplotlib.collections import LineCollection

        self.actor, self.azimuth = actor, azimuth
        self.floor = axes.add_collection(LineCollection([], colors="#dddddd", linewidths=0.8))
        self.body = axes.add_collection(
            LineCollection([], colors=actor.colour, linewidths=2.6, capstyle="round")
        )
        height = np.quantile(actor.positions[..., 1], 0.98)
        axes.set(xlim=(-half, half), ylim=(-0.3, max(height + 0.3, 1.9)))
        axes.set_aspect("equal")
        axes.axis("off")
        axes.text(0.5, 0.97, actor.label, transform=axes.transAxes, ha="center", va="top")

    def draw(self, frame: int) -> tuple:
        points = self.actor.positions[frame]
        followed = floor_point(points)
        self.body.set_segments(
            bones(camera_view(points - followed, self.azimuth), self.actor.parents)
        )
        self.floor.set_segments(camera_view(self._floor(followed), self.azimuth))
        return self.body, self.floor

    def _floor(self, followed: np.ndarray) -> np.ndarray:
        """Lines of the floor around the body, fixed in the world."""
        shift = np.mod(followed, self._TILE)
        lines = []
        for along in np.arange(-2, 3) * self._TILE:
            lines.append([[along, 0, -1], [along, 0, 1]])
            lines.append([[-1, 0, along], [1, 0, along]])
        lines = np.array(lines, dtype=float)
        lines[0::2, :, 0] -= shift[0]
        lines[1::2, :, 2] -= shift[2]
        return lines
