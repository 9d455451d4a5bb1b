"""Motions in an interactive viewer: one HTML file that needs no network.

`viewer_page/viewer.js` draws with three.js. A page has the script once (`head`) and any number of
motions (`fragment`). Positions are packed: the root as float32, and each joint's offset from the
root as int16 in steps of at most 0.1 mm for a body of human size. Differences between frames are
stored, compressed by zlib, in base64.
"""

import base64
import json
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.visible import visible
from numpy_cae.viz.actor import Actor

_FOLDER = files("numpy_cae.viz") / "viewer_page"
_LARGEST = np.iinfo(np.int16).max
_BONE_RADIUS = 0.011
"""BONE_RADIUS: a bone's radius as a share of the body's height."""
DAMAGED_COLOUR, MOVED_COLOUR = "#e8a33a", "#d62728"


def save_viewer(
    actors: Sequence[Actor], path: str | Path, rate: float, title: str = "", overlaid: bool = False
) -> None:
    """Write a page that plays motions side by side or overlaid, atomically.

    Parameters
    ----------
    actors : sequence of Actor
        The shorter ones hold their last pose until the longest ends.
    path : path of the .html file
    rate : float
        Frames a second of the motions.
    title : str
        Of the page; by default the labels of the motions.
    overlaid : bool
        Start with all motions in one place instead of side by side.
    """
    with atomic_write(path) as temporary:
        Path(temporary).write_text(page_html(actors, rate, title, overlaid), encoding="utf-8")


def page_html(actors: Sequence[Actor], rate: float, title: str = "", overlaid: bool = False) -> str:
    """The page that `save_viewer` writes."""
    title = title or ", ".join(actor.label for actor in actors)
    viewer = fragment(actors, rate, overlaid, "whole")
    page = Template(_text("page.html"))
    return page.substitute(title=escape(visible(title)), head=head(), viewer=viewer)


@cache
def head() -> str:
    """The style and the scripts that a page with viewers needs once, after its motions."""
    modules = {
        "three": "three/three.module.min.js",
        "three-orbit-controls": "three/OrbitControls.js",
        "motion-viewer": "viewer.js",
    }
    packed = {name: _deflated(_text(file).encode()) for name, file in modules.items()}
    return (
        f"<style>{_text('viewer.css')}</style>\n"
        f'<script type="application/json" id="viewer-modules">{json.dumps(packed)}</script>\n'
        f"<script>{_text('start.js')}</script>"
    )


def fragment(actors: Sequence[Actor], rate: float, overlaid: bool = False, style: str = "") -> str:
    """The HTML of one viewer; the page needs `head` too. Arguments as in `save_viewer`."""
    longest = max(len(actor.positions) for actor in actors)
    actors = [
        actor.at_frames(np.minimum(np.arange(longest), len(actor.positions) - 1))
        for actor in actors
    ]
    furthest = max((float(a.moved.max()) for a in actors if a.moved is not None), default=0.0)
    height = max(float(np.median(np.ptp(actor.positions[..., 1], axis=1))) for actor in actors)
    width = max(float(np.ptp(actor.positions[:, :, 0], axis=1).max()) for actor in actors)
    data = {
        "rate": rate,
        "frames": longest,
        "size": max(width, 0.6 * height, 1e-3) * 1.15,
        "overlaid": overlaid,
        "furthest": furthest,
        "motions": [_packed(actor, furthest, _BONE_RADIUS * height) for actor in actors],
        "tracks": [track for actor in actors for track in _tracks(actor, actors[0], furthest)],
    }
    # "</script>" in a joint's name must not end the element.
    text = json.dumps(data).replace("<", "\\u003c")
    return f'<script type="application/json" class="viewer-data {style}">{text}</script>'


def _text(name: str) -> str:
    return _FOLDER.joinpath(name).read_text(encoding="utf-8")


def _packed(actor: Actor, furthest: float, radius: float) -> dict:
    positions = np.asarray(actor.positions, dtype=np.float64)
    root = positions[:, 0].astype("<f4")
    local = positions - root[:, None].astype(np.float64)
    step = max(1e-4, float(np.abs(local).max()) / _LARGEST)
    steps = np.round(local / step).astype("<i2")
    differences = np.diff(steps, axis=0, prepend=np.zeros_like(steps[:1]))
    packed = {
        "label": actor.label,
        "colour": actor.colour,
        "names": [*actor.names] or [f"joint {joint}" for joint in range(positions.shape[1])],
        "parents": [int(parent) for parent in actor.parents],
        "root": _deflated(root.tobytes()),
        "local": _deflated(differences.tobytes()),
        "step": step,
        "radius": radius,
        "furthest": furthest,
    }
    if actor.moved is not None and furthest > 0:
        levels = np.ceil(actor.moved / furthest * 255).astype(np.uint8)
        packed["moved"] = _deflated(levels.tobytes())
    return packed


def _deflated(values: bytes) -> str:
    return base64.b64encode(zlib.compress(values, 9)).decode()


def _tracks(actor: Actor, first: Actor, furthest: float) -> list[dict]:
    """Rows of the timeline: the share of damaged joints and the largest distance of a joint."""
    tracks = []
    if actor.damaged is not None:
        share = np.where(actor.damaged.any(axis=1), 0.25 + 0.75 * actor.damaged.mean(axis=1), 0.0)
        tracks.append(("damaged", DAMAGED_COLOUR, share))
    if actor.moved is not None and furthest > 0:
        share = actor.moved.max(axis=1) / furthest
        tracks.append((f"distance from {first.label}", MOVED_COLOUR, share))
    return [
        {"label": f"{actor.label}: {label}", "colour": colour, "values": share.round(2).tolist()}
        for label, colour, share in tracks
    ]


@dataclass(frozen=True, repr=False)
class Player:
    """A viewer as the result of a notebook's cell, in a frame of its own."""

    page: str
    label: str
    height: int

    def __repr__(self) -> str:
        return f"an animation: {self.label}"

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.page)}" title="{escape(self.label)}" '
            f'style="width: 100%; height: {self.height}px; border: 0"></iframe>\n'
            f"<p>Animation: {escape(self.label)}. It plays in Jupyter and in any browser.</p>"
        )


def in_notebook(actors: Sequence[Actor], rate: float, height: int = 420) -> Player:
    """Motions side by side with play, pause and a slider, for the last line of a cell.

    Parameters
    ----------
    actors, rate
        As in `save_viewer`. The viewer takes 260 kB of the notebook, ten seconds of three motions
        about 150 kB more.
    height : int
        Of the frame, in pixels.
    """
    return Player(page_html(actors, rate), ", ".join(actor.label for actor in actors), height)
