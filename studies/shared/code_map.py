"""A page with takes as points of a map: a click plays the take.

`code_map.js` draws the points in `code_map.html`, and shows the take that is chosen in the viewer
of `numpy_cae.viz`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

import numpy as np

from numpy_cae.viz.actor import Actor
from numpy_cae.viz.viewer import head, json_in_page, viewer_data

HERE = Path(__file__).parent


@dataclass(frozen=True, eq=False)
class MapPoint:
    """A take on the map.

    Parameters
    ----------
    label, kind : str
        Points of a kind have the same colour and shape.
    place : (2,) array of float
    path : (N, 2) array of float
        The places of the corners of a path that ends in `place`.
    actors : sequence of Actor
        The motions that a click plays.
    text : str
        What is said of the take when it is chosen.
    """

    label: str
    kind: str
    place: np.ndarray
    path: np.ndarray
    actors: Sequence[Actor]
    text: str = ""


def code_map_page(points: Sequence[MapPoint], rate: float, title: str, text: str) -> str:
    """The HTML of a page with a map of the points; `rate` in frames a second."""
    takes = []
    for point in points:
        take = {
            "label": point.label,
            "kind": point.kind,
            "place": np.round(point.place, 4).tolist(),
            "path": np.round(point.path, 4).tolist(),
            "motions": viewer_data(point.actors, rate),
            "text": point.text,
        }
        takes.append(take)
    page = Template((HERE / "code_map.html").read_text("utf-8"))
    script = (HERE / "code_map.js").read_text("utf-8")
    return page.substitute(
        title=escape(title),
        text=escape(text),
        takes=json_in_page(takes),
        head=head(codemap=script),
    )
