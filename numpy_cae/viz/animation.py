"""A motion as an animated GIF."""

from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.viz.actor import Actor
from numpy_cae.viz.camera import bones, camera_view, floor_point

FPS, HEIGHT = 15.0, 420
"""Pictures a second, at most the rate of the motions; pixels."""


def save_gif(
    actors: list[Actor],
    path: str | Path,
    rate: float,
    azimuth: float = 40.0,
    seconds: float = 20.0,
    overlaid: bool = False,
) -> str:
    """Write motions side by side or overlaid as a GIF; a camera follows them over a floor.

    Parameters
    ----------
    actors : list of Actor, of the same number of frames
    rate : float
        Frames a second of the motions.
    azimuth : float
        Degrees from which the camera looks.
    seconds : float
        A longer motion is truncated.
    overlaid : bool
        All motions in one panel, whose camera follows the first.

    Returns
    -------
    str
        What the animation shows: "all 8.9 s" or "the first 20.0 s of 61.2 s".
    """
    from matplotlib.animation import FuncAnimation, PillowWriter
    from matplotlib.figure import Figure

    step = _step(rate)
    frames = len(actors[0].positions)
    moments = range(0, min(frames, int(seconds * rate)), step)
    half = _half_width(actors, moments, azimuth)
    groups = [actors] if overlaid else [[actor] for actor in actors]
    figure = Figure(figsize=(2.4 * half * len(groups), 2.8))
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    panels = [
        _Panel(figure.add_subplot(1, len(groups), place + 1), group, azimuth, half)
        for place, group in enumerate(groups)
    ]

    def draw(frame: int) -> list:
        return [artist for panel in panels for artist in panel.draw(frame)]

    animation = FuncAnimation(figure, draw, frames=moments, blit=False, init_func=lambda: [])
    with atomic_write(path) as beside:
        animation.save(beside, writer=PillowWriter(fps=rate / step), dpi=HEIGHT / 2.8)
    shown, whole = min(frames / rate, seconds), frames / rate
    return f"all {whole:.1f} s" if shown == whole else f"the first {shown:.1f} s of {whole:.1f} s"


def _step(rate: float) -> int:
    """Every how many frames a picture is drawn, about `FPS` a second.

    A GIF counts hundredths of a second, so only steps that last a whole number of them play at the
    right speed: 30 frames a second in steps of 3 take 10 hundredths each, in steps of 2 6.67.
    """
    steps = range(max(1, round(rate / FPS)), max(2, int(rate / 5)) + 1)
    return min(steps, key=lambda step: round(abs(100 * step / rate - round(100 * step / rate)), 3))


def _half_width(actors: list[Actor], moments: range, azimuth: float) -> float:
    """Half the width of a panel in metres: more for a body that lies down."""
    shown = [actor.positions[moment] for actor in actors for moment in moments]
    reach = max(
        np.abs(camera_view(points - floor_point(points), azimuth)[:, 0]).max() for points in shown
    )
    return float(np.clip(reach + 0.1, 0.9, 1.6))


class _Panel:
    """The part of the picture with one motion, or with several overlaid."""

    _TILE = 0.5  # metres between two lines of the floor

    def __init__(self, axes, actors: list[Actor], azimuth: float, half: float):
        from matplotlib.collections import LineCollection

        self.actors, self.azimuth = actors, azimuth
        self.floor = axes.add_collection(LineCollection([], colors="#dddddd", linewidths=0.8))
        style = {"linewidths": 2.6, "capstyle": "round", "alpha": 1.0 if len(actors) == 1 else 0.75}
        self.bodies = [
            axes.add_collection(LineCollection([], colors=actor.colour, **style))
            for actor in actors
        ]
        height = max(np.quantile(actor.positions[..., 1], 0.98) for actor in actors)
        axes.set(xlim=(-half, half), ylim=(-0.3, np.clip(height + 0.3, 1.9, 10.0)))
        axes.set_aspect("equal")
        axes.axis("off")
        for line, actor in enumerate(actors):
            name = {"ha": "center", "va": "top", "fontsize": 8, "color": actor.colour}
            axes.text(0.5, 0.98 - 0.05 * line, actor.label, transform=axes.transAxes, **name)

    def draw(self, frame: int) -> tuple:
        followed = floor_point(self.actors[0].positions[frame])
        for body, actor in zip(self.bodies, self.actors, strict=True):
            points = actor.positions[frame] - followed
            body.set_segments(bones(camera_view(points, self.azimuth), actor.parents))
        self.floor.set_segments(camera_view(self._floor(followed), self.azimuth))
        return (*self.bodies, self.floor)

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
