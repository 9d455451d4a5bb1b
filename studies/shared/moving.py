"""Clips that move side by side, with their labels, as a GIF."""

import io
from collections.abc import Sequence
from textwrap import fill

import numpy as np

from numpy_cae.viz.actor import Actor
from numpy_cae.viz.camera import bones, camera_view

COLUMNS = 4
APART = 2.2
"""APART: the distance of two bodies in the picture (m)."""
PIXELS = 640
LETTERS = 30
"""LETTERS: a line of a label has at most this many."""


def gif(actors: Sequence[Actor], rate: float) -> bytes:
    """A GIF of all actors in rows of `COLUMNS`, each below its label."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure
    from PIL import Image

    rows = -(-len(actors) // COLUMNS)
    size = (PIXELS / 100, rows / COLUMNS * PIXELS / 100)
    figure = Figure(figsize=size, dpi=100, layout="constrained")
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    axes.set(xlim=(-APART / 2, (COLUMNS - 0.5) * APART), ylim=((0.9 - rows) * APART, APART))
    axes.set_aspect("equal")
    axes.axis("off")
    places = [np.array([n % COLUMNS, -(n // COLUMNS)]) * APART for n in range(len(actors))]
    for actor, (x, y) in zip(actors, places, strict=True):
        axes.text(x, y + 0.85 * APART, fill(actor.label, LETTERS), ha="center", size=6)
    lines = [axes.add_collection(LineCollection([], colors=a.colour, lw=1.5)) for a in actors]
    pictures = []
    for frame in range(len(actors[0].positions)):
        for number, actor in enumerate(actors):
            points = actor.positions[frame]
            body = camera_view(points - points.mean(axis=0) * [1.0, 0.0, 1.0], 40.0)
            lines[number].set_segments(bones(body + places[number], actor.parents))
        canvas.draw()
        pictures.append(Image.fromarray(np.array(canvas.buffer_rgba())).convert("P"))
    file = io.BytesIO()
    shown = {"duration": round(1000 / rate), "loop": 0, "append_images": pictures[1:]}
    pictures[0].save(file, format="gif", save_all=True, **shown)
    return file.getvalue()
