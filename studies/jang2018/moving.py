"""Clips that move side by side, as a GIF."""

import io
from collections.abc import Sequence

import numpy as np

from numpy_cae.viz.actor import Actor
from numpy_cae.viz.camera import bones, camera_view

COLUMNS = 4
APART = 2.2
"""APART: the distance of two bodies in the picture (m)."""
PIXELS = 480


def gif(actors: Sequence[Actor], rate: float) -> bytes:
    """A GIF of all actors in rows of `COLUMNS`, each in the middle of its place."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure
    from PIL import Image

    figure = Figure(figsize=(PIXELS / 100, PIXELS / 100), dpi=100, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    rows = -(-len(actors) // COLUMNS)
    axes.set(xlim=(-APART / 2, (COLUMNS - 0.5) * APART), ylim=((0.9 - rows) * APART, APART))
    axes.set_aspect("equal")
    axes.axis("off")
    lines = [axes.add_collection(LineCollection([], colors=a.colour, lw=1.5)) for a in actors]
    pictures = []
    for frame in range(len(actors[0].positions)):
        for number, actor in enumerate(actors):
            points = actor.positions[frame]
            body = camera_view(points - points.mean(axis=0) * [1.0, 0.0, 1.0], 40.0)
            place = np.array([number % COLUMNS, -(number // COLUMNS)]) * APART
            lines[number].set_segments(bones(body + place, actor.parents))
        canvas.draw()
        pictures.append(Image.fromarray(np.array(canvas.buffer_rgba())).convert("P"))
    file = io.BytesIO()
    shown = {"duration": round(1000 / rate), "loop": 0, "append_images": pictures[1:]}
    pictures[0].save(file, format="gif", save_all=True, **shown)
    return file.getvalue()
