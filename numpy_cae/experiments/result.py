"""The result of an experiment, as text, JSON, PNG and a viewer; `page` makes HTML of it."""

from __future__ import annotations

import io
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.experiments.text_table import text_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from numpy_cae.viz.actor import Actor, Motions


@dataclass(frozen=True)
class Table:
    """Plain values with a heading for each column; the first value of a row is its name.

    A value that is None or nan is an empty cell; a str or an int is printed as it is. `formats`
    are of the floats: one format for all columns, or one for each. `best` says which of the floats
    the page marks: "low" or "high" the best of each column, "low across" the lowest of each row.
    Rows of one column are compared if their names agree up to the last ": ".
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[object]]
    formats: str | Sequence[str] = ".2f"
    best: str = ""

    def best_cells(self) -> set[tuple[int, int]]:
        """Row and column of each value that is marked as the best."""
        compared = defaultdict(list)
        for place, row in enumerate(self.rows):
            group = row[0] if str in map(type, row[1:2]) else str(row[0]).rpartition(": ")[0]
            for column, value in enumerate(row):
                if isinstance(value, float | np.floating) and not np.isnan(value):
                    key = place if self.best == "low across" else (column, group)
                    compared[key].append((float(value), (place, column)))
        choose = max if self.best == "high" else min
        winners = [choose(values)[0] for values in compared.values()]
        pairs = zip(winners, compared.values(), strict=True)
        return {cell for won, each in pairs for value, cell in each if self.best and value == won}

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
    """A sentence about a method, and whether the measurement confirms the sentence.

    Parameters
    ----------
    sentence : str
        With its source, such as "(holden2015, section 7)".
    confirmed : bool
    figures : str
        The measured figures that decide, in a sentence.
    """

    sentence: str
    confirmed: bool
    figures: str

    @property
    def status(self) -> str:
        """The words "confirmed" or "not confirmed"."""
        return "confirmed" if self.confirmed else "not confirmed"

    def text(self) -> str:
        """One line for a terminal."""
        return f"{self.status}: {self.sentence} Measured: {self.figures}"


@dataclass(frozen=True)
class Animation:
    """Motions for the viewer, and their frames a second."""

    actors: list[Actor]
    rate: float


def moving(
    motions: Motions, rate: float, azimuth: float = 40.0
) -> tuple[Callable[[], Figure], Animation]:
    """The figure and the animation of a `Result` that shows motions: as strips, and moving.

    The strips are seen from `azimuth`, in degrees.
    """
    from numpy_cae.viz import strip_figure
    from numpy_cae.viz.actor import local_actors, world_actors

    def figure() -> Figure:
        return strip_figure(local_actors(motions), rate, azimuth=azimuth)

    return figure, Animation(world_actors(motions), rate)


@dataclass(frozen=True)
class Result:
    """What an experiment measured; a notebook shows it as a section of the report.

    Parameters
    ----------
    title : str
    tables : sequence of Table
    claims : sequence of Claim
    figure : function without arguments, optional
        Draws the figure. It is called when a picture is requested, so that text needs no
        Matplotlib.
    animation : Animation, optional
    note : str
        What was measured on which data.
    """

    title: str
    tables: Sequence[Table]
    claims: Sequence[Claim] = ()
    figure: Callable[[], Figure] | None = None
    animation: Animation | None = None
    note: str = ""

    @property
    def confirmed(self) -> int:
        """The number of claims that are confirmed."""
        return sum(bool(claim.confirmed) for claim in self.claims)

    def text(self) -> str:
        """The tables in Markdown's form, then the note."""
        parts = [table.text() for table in self.tables]
        return "\n\n".join([*parts, self.note] if self.note else parts)

    def data(self) -> dict:
        """Everything but the pictures and the formats, in the types of JSON and NumPy's numbers."""
        tables = [
            {
                "caption": table.caption,
                "header": table.header,
                # JSON has no NaN, the mark of an empty cell.
                "rows": [[None if cell != cell else cell for cell in row] for row in table.rows],
            }
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

    def _repr_html_(self) -> str:
        from numpy_cae.experiments.page import section

        return section(self)


def _printed(value: object, form: str) -> str:
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else format(float(value), form)
    return "" if value is None else str(value)
