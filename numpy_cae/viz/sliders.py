"""Figures with sliders, which need neither a kernel nor a network.

A page embeds a table with a row for each position of the controls, and `slider.js`, which draws the
row at which the controls stand as SVG. A sentence for each position says the same as the drawing.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import chain
from math import prod
from string import Template
from typing import Any

import numpy as np

from numpy_cae.viz.actor import Actor
from numpy_cae.viz.colours import OTHERS
from numpy_cae.viz.viewer import Player, deflated, page_text

_LARGEST = 300_000
"""The page of a figure has at most this number of bytes."""
_STEP = 0.005
"""Positions of joints are rounded to multiples of this (m)."""


@dataclass(frozen=True, eq=False)
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


@dataclass(frozen=True, eq=False)
class Chart:
    """Curves over one pair of axes, as a part of a figure with sliders.

    Parameters
    ----------
    title : str
    curves : sequence of Curve
        An x or y of shape (positions, points) has a row for each position of the controls; one of
        shape (points,) is drawn at every position. The styles "o" and "." draw points, "--" dashes.
    across, up : str
        Labels of the axes, with units.
    log : str
        The axes that are logarithmic: "", "x", "y" or "xy".
    """

    title: str
    curves: Sequence[Curve]
    across: str
    up: str
    log: str = ""


def slider_figure(
    title: str,
    controls: Mapping[str, Sequence[float]],
    panels: Sequence[Chart | Sequence[Actor]],
    texts: Sequence[str],
    rate: float = 30.0,
    start: int = 0,
) -> Player:
    """A figure with a slider for each control, drawn in the browser from a table.

    Parameters
    ----------
    title : str
    controls : mapping of str to sequence of float
        The name of each control and the values that it takes. With several controls, the positions
        are all combinations of their values, the last control changing fastest.
    panels : sequence of Chart or of sequences of Actor
        Drawn side by side. The actors of a panel stand beside one another and play in a loop, each
        on the spot; an actor whose positions have shape (positions, F, J, 3) has a motion for each
        position of the controls.
    texts : sequence of str
        For each position, what is seen there: shown below the drawing and read to those who do not
        see it.
    rate : float
        Frames a second of the actors.
    start : int
        The position at which the controls stand at first.

    Returns
    -------
    Player
        It shows itself in a notebook; `page` is the whole HTML page.

    Raises
    ------
    ValueError
        If the number of texts or rows is not that of the positions, or the page is too large.

    Examples
    --------
    >>> from numpy_cae.viz import Chart, Curve, slider_figure
    >>> x, slopes = np.linspace(-1, 1, 5), [0.5, 1.0, 2.0]
    >>> line = Curve(x, np.outer(slopes, x), "a line")
    >>> slider_figure("the slope of a line", {"slope a": slopes},
    ...               [Chart("y = a x", [line], "x", "y")], [f"slope {a}" for a in slopes])
    a figure with sliders: the slope of a line
    slope 0.5
    slope 1.0
    slope 2.0
    """
    positions = prod(len(values) for values in controls.values())
    colours = iter(OTHERS)
    drawn = []
    for panel in panels:
        if isinstance(panel, Chart):
            drawn.append(_chart_table(panel, colours))
        else:
            actors = [_actor_table(actor) for actor in panel]
            drawn.append({"title": "", "rate": rate, "actors": actors})
    _require_rows(texts, positions)
    for rows in chain.from_iterable(_varying_rows(panel) for panel in drawn):
        _require_rows(rows, positions)
    sliders = [{"name": name, "values": _four_digits(v)} for name, v in controls.items()]
    table = {"controls": sliders, "panels": drawn, "start": start}
    page = Template(page_text("slider.html")).substitute(
        title=escape(title),
        table=deflated(json.dumps(table).encode()),
        texts="\n".join(f"<li>{escape(text)}</li>" for text in texts),
        script=page_text("slider.js"),
    )
    if len(page.encode()) > _LARGEST:
        raise ValueError(f"{title}: the page has {len(page.encode())} bytes, at most {_LARGEST}")
    return Player(page, f"a figure with sliders: {title}", 430, tuple(texts))


def _require_rows(rows: Sequence[object], positions: int) -> None:
    """Raise ValueError unless there is a row for each position of the controls."""
    if len(rows) != positions:
        raise ValueError(f"{len(rows)} rows or texts for {positions} positions of the controls")


def _four_digits(values: Any) -> list[Any]:
    """Four digits of each number; null where it is not finite."""
    if np.ndim(values) > 1:
        return [_four_digits(row) for row in values]
    return [float(f"{value:.4g}") if np.isfinite(value) else None for value in values]


def _chart_table(chart: Chart, colours: Iterator[str]) -> dict[str, Any]:
    """A chart with the numbers of its curves; those without a colour take the next one."""
    curves = []
    for curve in chart.curves:
        numbers = {"x": _four_digits(curve.x), "y": _four_digits(curve.y)}
        curves.append({**vars(curve), **numbers, "colour": curve.colour or next(colours)})
    return {**vars(chart), "curves": curves}


def _actor_table(actor: Actor) -> dict[str, Any]:
    """An actor with its root above one place, in steps; differences of frames."""
    points = np.asarray(actor.positions, dtype=float)
    points = points[None] if points.ndim == 3 else points
    points = points - points[:, :, :1] * [1.0, 0.0, 1.0]
    steps = np.round(points / _STEP).astype(int)
    return {
        "label": actor.label,
        "colour": actor.colour,
        "parents": [int(parent) for parent in actor.parents],
        "clips": np.diff(steps, axis=1, prepend=0).reshape(*steps.shape[:2], -1).tolist(),
    }


def _varying_rows(panel: dict[str, Any]) -> list[list[Any]]:
    """What has a row for each position of the controls."""
    varying = []
    for curve in panel.get("curves", ()):
        varying += [curve[axis] for axis in "xy" if isinstance(curve[axis][0], list)]
    for actor in panel.get("actors", ()):
        if len(actor["clips"]) > 1:
            varying.append(actor["clips"])
    return varying
