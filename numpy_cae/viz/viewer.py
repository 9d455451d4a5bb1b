"""Motions in an interactive viewer: one HTML file that needs no network.

`viewer_page/viewer.js` draws with three.js. A page has the scripts once (`head`) and any number of
viewers (`fragment`), each with a motion or more. Positions are packed in steps of 0.4 mm: the first
joint in the world, each other joint from the first one. A motion with as many joints as the first
motion is stored as its difference from that one. Differences between frames are stored with the
sign in the lowest bit, in four planes of bytes, compressed by zlib, in base64.
"""

import base64
import json
import sys
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from importlib.resources import files
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

from numpy_cae.atomic_write import atomic_write, stamped
from numpy_cae.visible import visible
from numpy_cae.viz.actor import Actor

_FOLDER = files("numpy_cae.viz") / "viewer_page"
_MODULES = {"three": "three/three.module.min.js", "three-orbit-controls": "three/OrbitControls.js"}
_SCRIPTS = ("data", "trail", "figure", "stage", "timeline", "findings", "film", "viewer")
_MODULES |= {f"motion-{script}": f"{script}.js" for script in _SCRIPTS}
"""Name by which a script imports another, and its file."""
_STEP = 4e-4
"""Positions are packed in multiples of this (m)."""
SCALE = (0.01, 0.5)
"""The colours of distances go, by the logarithm, from the first of these to the second (m);
a joint below is grey, one beyond has the last colour."""


def running_shell() -> Any:
    """The IPython that runs this; None in plain Python, where IPython need not be installed."""
    ipython = sys.modules.get("IPython")
    return ipython and ipython.get_ipython()


def save_viewer(
    actors: Sequence[Actor],
    path: str | Path,
    rate: float,
    title: str = "",
    summary: Sequence[str] = (),
    measures: Sequence[tuple[str, str, str]] = (),
    **shown: Any,
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
    summary : sequence of str
        What the page says first.
    measures : sequence of (str, str, str)
        A name with its unit, and its value before and after; a smaller one is better.
    shown
        Arguments of `fragment`: overlaid, findings, command and rows.
    """
    page = page_html(actors, rate, title, **shown)
    page = page.replace("</h1>", f"</h1>\n{_summary_html(summary, measures)}", 1)
    with atomic_write(path) as temporary:
        temporary.write_text(stamped(page), encoding="utf-8", newline="\n")


def _summary_html(summary: Sequence[str], measures: Sequence[tuple[str, str, str]]) -> str:
    if not summary:
        return ""
    sentences = "".join(f"<li>{escape(visible(text))}</li>" for text in summary)
    rows = "".join(
        f"<tr><th scope=row>{escape(name)}</th><td>{before}</td><td>{after}</td></tr>"
        for name, before, after in measures
    )
    head = "<tr><td></td><th scope=col>before</th><th scope=col>after</th></tr>"
    words = page_text("words.html")
    return f'<div class="summary"><ul>{sentences}</ul><table>{head}{rows}</table>{words}</div>'


def page_html(actors: Sequence[Actor], rate: float, title: str = "", **shown: Any) -> str:
    """A page that plays motions; arguments as in `save_viewer`."""
    title = title or ", ".join(actor.label for actor in actors)
    viewer = fragment(actors, rate, "whole", **shown)
    page = Template(page_text("page.html"))
    return page.substitute(title=escape(visible(title)), head=head(), viewer=viewer)


@cache
def head(**scripts: str) -> str:
    """The style and the scripts that a page with viewers needs once, after its motions.

    `scripts` are further modules, name to text, which are run after the viewer's.
    """
    texts = {name: page_text(file) for name, file in _MODULES.items()} | scripts
    packed = {name: deflated(text.encode()) for name, text in texts.items()}
    return (
        f"<style>{page_text('viewer.css')}</style>\n"
        f'<script type="application/json" id="viewer-modules">{json.dumps(packed)}</script>\n'
        f"<script>{page_text('start.js')}</script>"
    )


def fragment(
    actors: Sequence[Actor],
    rate: float,
    style: str = "",
    overlaid: bool = False,
    findings: Sequence[Mapping[str, Any]] = (),
    command: str = "",
    rows: Mapping[str, np.ndarray] | None = None,
) -> str:
    """The HTML of one viewer; the page needs `head` too.

    Parameters
    ----------
    actors, rate
        As in `save_viewer`.
    style : str
        A viewer of the style "whole" fills its page, has the page's keys and follows #frame=58 in
        its address.
    overlaid : bool
        Start with all motions in one place instead of side by side. The first is translucent.
    findings : sequence of dict
        What the page lists as damaged: "joint", "frames" (first and last), and optionally "kind",
        "evidence", "cm", "mover", "confidence" (0 to 1) and "status"; "event" and "place" of those
        that are listed as one (`cleanup.events.rows_of_events`).
    command : str
        A command line that repairs everything, into a file whose name ends in "_finding_0". The
        page writes the number of a finding there, and adds --only.
    rows : mapping of str to (F,) array of float, optional
        The name and the values, 0 to 1, of rows of bars below the slider.
    """
    data = viewer_data(actors, rate, overlaid, findings, command, rows)
    text = json_in_page(data)
    labels = escape(", ".join(actor.label for actor in actors))
    return (
        f'<script type="application/json" class="viewer-data {style}">{text}</script>'
        f"<noscript><p>An animation of {labels}. It needs JavaScript, which is switched off."
        "</p></noscript>"
    )


def viewer_data(
    actors: Sequence[Actor],
    rate: float,
    overlaid: bool = False,
    findings: Sequence[Mapping[str, Any]] = (),
    command: str = "",
    rows: Mapping[str, np.ndarray] | None = None,
) -> dict[str, Any]:
    """What `mount` of viewer.js shows, in JSON's types; arguments as in `fragment`."""
    longest = max(len(actor.positions) for actor in actors)
    return {
        "rate": rate,
        "frames": longest,
        "overlaid": overlaid,
        "scale": SCALE,
        "motions": [_pack(actor, actors[0], longest) for actor in actors],
        "findings": list(findings),
        "command": visible(command),
        "rows": {visible(name): np.round(row, 3).tolist() for name, row in (rows or {}).items()},
    }


def json_in_page(data: Any) -> str:
    """JSON for a script element, which "</script>" in a joint's name must not end."""
    return json.dumps(data).replace("<", "\\u003c")


def page_text(name: str) -> str:
    """A file of the folder `viewer_page`."""
    return _FOLDER.joinpath(name).read_text(encoding="utf-8")


def _pack(actor: Actor, first: Actor, frames: int) -> dict[str, Any]:
    """A motion in so many frames, of which the last ones repeat its last pose."""
    step = max(_STEP, float(np.nanmax(np.abs(first.positions))) / 2**28)
    steps = _steps(actor.positions, step, frames)
    from_first = actor is not first and len(actor.parents) == len(first.parents)
    if from_first:
        steps -= _steps(first.positions, step, frames)
    differences = np.diff(steps, axis=1, prepend=0)
    signed = (differences << 1) ^ (differences >> 31)
    packed = {
        "label": actor.label,
        "colour": actor.colour,
        "names": [*actor.names] or [f"joint {joint}" for joint in range(len(actor.parents))],
        "parents": [int(parent) for parent in actor.parents],
        "steps": deflated(signed.astype("<u4").view(np.uint8).reshape(-1, 4).T.tobytes()),
        "from_first": from_first,
        "step": step,
    }
    if actor.moved is not None:
        levels = np.pad(_levels(actor.moved), ((0, frames - len(actor.moved)), (0, 0)), "edge")
        packed["moved"] = deflated(levels.T.tobytes())
    return packed


def _levels(moved: np.ndarray) -> np.ndarray:
    """Distances (m) on the scale of colours, uint8: 0 below it, 1 to 255 from end to end."""
    least, most = SCALE
    share = np.log(np.clip(np.nan_to_num(moved), least, most) / least) / np.log(most / least)
    return np.where(moved < least, 0, 1 + np.round(254 * share)).astype(np.uint8)


def _steps(positions: np.ndarray, step: float, frames: int) -> np.ndarray:
    """(3 J, F) int32: a row for each coordinate, that of a joint but the first from the first."""
    local = np.nan_to_num(np.asarray(positions, dtype=np.float64))
    local = np.concatenate([local[:, :1], local[:, 1:] - local[:, :1]], axis=1)
    steps = np.round(local / step).astype(np.int32).reshape(len(local), -1).T.copy()
    return np.pad(steps, ((0, 0), (0, frames - len(local))), "edge")


def deflated(values: bytes) -> str:
    """Bytes, compressed by zlib, in base64: `inflated` of start.js undoes it."""
    return base64.b64encode(zlib.compress(values, 9)).decode()


@dataclass(frozen=True, repr=False)
class Player:
    """A page as the result of a notebook's cell, in a frame of its own. The texts say in words what
    is seen, for those who do not see it."""

    page: str
    label: str
    height: int
    texts: tuple[str, ...] = ()

    def __repr__(self) -> str:
        rows = np.unique(np.linspace(0, len(self.texts) - 1, 9).round().astype(int))
        return "\n".join([self.label, *(self.texts[row] for row in rows if self.texts)])

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.page)}" title="{escape(self.label)}" '
            f'style="width: 100%; height: {self.height}px; border: 0"></iframe>'
        )


def in_notebook(
    actors: Sequence[Actor], rate: float, findings: Sequence[Mapping[str, Any]] = ()
) -> Player:
    """Motions with play, pause and a slider, for the last line of a cell: side by side, or with
    findings overlaid.

    Parameters
    ----------
    actors, rate, findings
        As in `save_viewer`. The viewer takes 260 kB of the notebook, ten seconds of three motions
        about 150 kB more.
    """
    page = page_html(actors, rate, overlaid=bool(findings), findings=findings)
    labels = ", ".join(actor.label for actor in actors)
    return Player(page, f"an animation: {labels}", 560 if findings else 420)
