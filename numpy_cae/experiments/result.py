"""The result of an experiment, as text, JSON, PNG and a viewer; `page` makes HTML of it."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from numpy_cae.viz import Actor, Motions


@dataclass(frozen=True)
class Table:
    """Plain values with a heading for each column; the first value of a row is its name.

    A value that is None or nan is an empty cell; a str or an int is printed as it is. `formats`
    are of the floats: one format for all columns, or one for each.
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[object]]
    formats: str | Sequence[str] = ".2f"

    def cells(self) -> list[list[str]]:
        """The rows as printed, without the header."""
        one = isinstance(self.formats, str)
        formats = [self.formats] * len(self.header) if one else self.formats
        return [list(map(_printed, row, formats)) for row in self.rows]

    def text(self) -> str:
        """The caption and the table in Markdown's form, padded for a terminal."""
        table = text_table(self.header, self.cells())
        return f"{self.caption}\n\n{table}" if self.caption else table

    def value(self, row: str, column: str) -> object:
        """The value in the row of that name, the column of that heading."""
        values = next(values for values in self.rows if values[0] == row)
        return values[list(self.header).index(column)]


@dataclass(frozen=True)
class Claim:
    """A sentence about the method with its source, whether it held in this measurement, and the
    measured figures that decide, in a sentence.
    """

    sentence: str
    held: bool
    figures: str

    def text(self) -> str:
        """One line for a terminal."""
        status = "held" if self.held else "not held"
        return f"{status}: {self.sentence} Measured: {self.figures}"


@dataclass(frozen=True)
class Animation:
    """Motions side by side, for the viewer."""

    actors: list[Actor]
    rate: float
    azimuth: float = 40.0
    seconds: float = 10.0


def moving(
    motions: Motions, rate: float, azimuth: float = 40.0, seconds: float = 10.0
) -> tuple[Callable[[], Figure], Animation]:
    """The figure and the animation of a `Result` that shows motions: as strips, and moving."""
    from numpy_cae.viz import local_actors, strip_figure, world_actors

    def figure() -> Figure:
        return strip_figure(local_actors(motions), rate, azimuth=azimuth)

    return figure, Animation(world_actors(motions), rate, azimuth, seconds)


@dataclass(frozen=True)
class Result:
    """What an experiment measured.

    `figure` is called when a picture is requested, so that text needs no Matplotlib. The note says
    what was measured on which data.
    """

    title: str
    tables: Sequence[Table]
    claims: Sequence[Claim] = ()
    figure: Callable[[], Figure] | None = None
    animation: Animation | None = None
    note: str = ""

    @property
    def held(self) -> int:
        """How many of the claims held."""
        return sum(bool(claim.held) for claim in self.claims)

    def text(self) -> str:
        """The tables in Markdown's form, then the note."""
        parts = [table.text() for table in self.tables]
        return "\n\n".join([*parts, self.note] if self.note else parts)

    def data(self) -> dict:
        """Everything but the pictures and the formats, for `cli.shared.output.print_json`."""
        tables = [
            {"caption": table.caption, "header": table.header, "rows": table.rows}
            for table in self.tables
        ]
        claims = [vars(claim) for claim in self.claims]
        return {"title": self.title, "tables": tables, "claims": claims, "note": self.note}

    def png(self) -> bytes:
        """The figure as PNG; empty where there is none."""
        if self.figure is None:
            return b""
        picture = io.BytesIO()
        self.figure().savefig(picture, format="png", dpi=110, facecolor="white")
        return picture.getvalue()

    def viewer(self) -> str:
        """The animation in the viewer, as HTML; empty where there is none."""
        if self.animation is None:
            return ""
        from numpy_cae.viz.viewer import fragment

        return fragment(self.animation.actors, self.animation.rate)

    def save_picture(self, path: str | Path) -> None:
        """Write the figure, which there must be, as a PNG file."""
        from numpy_cae.viz import save_figure

        save_figure(self.figure(), path)


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Columns in Markdown's form, padded: the first left-aligned, the others right-aligned."""
    cells = [list(header), *[list(row) for row in rows]]
    widths = [max(len(row[column]) for row in cells) for column in range(len(header))]

    def line(row: Sequence[str]) -> str:
        padded = [row[0].ljust(widths[0])]
        padded += [cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True)]
        return "| " + " | ".join(padded) + " |"

    rule = "|" + "|".join("-" * (width + 1) + (":" if n else "-") for n, width in enumerate(widths))
    return "\n".join([line(cells[0]), rule + "|", *[line(row) for row in cells[1:]]])


def _printed(value: object, form: str) -> str:
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else format(float(value), form)
    return "" if value is None else str(value)
