"""A table of measures as text, in Markdown's form, padded for a terminal."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Table:
    """Plain values with a heading for each column; the first value of a row is its name.

    A value that is None or nan is an empty cell; a str or an int is printed as it is. `formats`
    are of the floats: one format for all columns, or one for each.

    Examples
    --------
    >>> print(Table("Errors:", ["method", "cm"], [["network", 1.3], ["PCA", 2.06]]).text())
    Errors:
    <BLANKLINE>
    | method  |   cm |
    |---------|-----:|
    | network | 1.30 |
    | PCA     | 2.06 |
    """

    caption: str
    header: Sequence[str]
    rows: Sequence[Sequence[object]]
    formats: str | Sequence[str] = ".2f"

    def text(self) -> str:
        """The caption and the table: the first column is left-aligned, the others right-aligned."""
        one = isinstance(self.formats, str)
        formats = [self.formats] * len(self.header) if one else self.formats
        cells = [list(self.header), *(list(map(_printed, row, formats)) for row in self.rows)]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        rule = "|" + "|".join("-" * (width + 1) + ("-:"[n > 0]) for n, width in enumerate(widths))
        lines = [_line(row, widths) for row in cells]
        table = "\n".join([lines[0], rule + "|", *lines[1:]])
        return f"{self.caption}\n\n{table}" if self.caption else table

    def value(self, row: str, column: str) -> object:
        """The value in the row of that name, the column of that heading."""
        values = next(values for values in self.rows if values[0] == row)
        return values[list(self.header).index(column)]


def _line(row: Sequence[str], widths: Sequence[int]) -> str:
    padded = [row[0].ljust(widths[0])]
    padded += [cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True)]
    return "| " + " | ".join(padded) + " |"


def _printed(value: object, form: str) -> str:
    if isinstance(value, float | np.floating):
        return "" if np.isnan(value) else format(float(value), form)
    return "" if value is None else str(value)
