"""An animation inside a notebook, small enough to be stored with it."""

from __future__ import annotations

import base64
import io
import tempfile
from dataclasses import dataclass
from pathlib import Path

from numpy_cae.viz.actor import Actor
from numpy_cae.viz.animation import save_gif

COLOURS = 32


@dataclass(frozen=True, repr=False)
class Animation:
    """A GIF that is displayed as the result of a cell."""

    gif: bytes
    label: str

    def __repr__(self) -> str:
        return f"an animation: {self.label}"

    def _repr_html_(self) -> str:
        source = "data:image/gif;base64," + base64.b64encode(self.gif).decode()
        return f'<img alt="{self.label}" src="{source}">'


def in_notebook(
    actors: list[Actor],
    rate: float,
    fps: float = 10.0,
    azimuth: float = 40.0,
    seconds: float = 3.0,
) -> Animation:
    """Motions side by side, for the last line of a cell.

    Parameters
    ----------
    actors, rate, fps, azimuth, seconds
        As in `save_gif`. Three motions of three seconds take about 250 kB.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "animation.gif")
        save_gif(actors, path, rate, fps, azimuth, seconds)
        return Animation(_few_colours(path), ", ".join(actor.label for actor in actors))


def _few_colours(path: Path) -> bytes:
    """The GIF in 32 colours, which halves its size."""
    from PIL import Image, ImageSequence

    with Image.open(path) as gif:
        frames = [frame.convert("RGB") for frame in ImageSequence.Iterator(gif)]
        duration = gif.info["duration"]
    palette = frames[0].quantize(COLOURS)
    first, *others = [f.quantize(palette=palette, dither=Image.Dither.NONE) for f in frames]
    packed = io.BytesIO()
    first.save(packed, "GIF", save_all=True, append_images=others, duration=duration, loop=0)
    return packed.getvalue()
