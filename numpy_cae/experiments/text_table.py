"""A table as text, in Markdown's form, padded for a terminal."""

from collections.abc import Sequence


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """The table's lines: the first column is left-aligned, the others are right-aligned.

    Examples
    --------
    >>> print(text_table(["method", "cm"], [["network", "1.3"], ["PCA", "2.06"]]))
    | method  |   cm |
    |---------|-----:|
    | network |  1.3 |
    | PCA     | 2.06 |
    """
    cells = [list(header), *[list(row) for row in rows]]
    widths = [max(len(row[column]) for row in cells) for column in range(len(header))]

    def line(row: Sequence[str]) -> str:
        padded = [row[0].ljust(widths[0])]
        padded += [cell.rjust(width) for cell, width in zip(row[1:], widths[1:], strict=True)]
        return "| " + " | ".join(padded) + " |"

    rule = "|" + "|".join("-" * (width + 1) + (":" if n else "-") for n, width in enumerate(widths))
    return "\n".join([line(cells[0]), rule + "|", *[line(row) for row in cells[1:]]])
