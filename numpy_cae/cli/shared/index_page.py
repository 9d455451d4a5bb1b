"""The page that lists the files of a command: those that could not be used first, then those that
were changed or have proposals, and, folded, those that are clean."""

import os
import urllib.parse
from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template
from typing import NamedTuple

from numpy_cae.atomic_write import atomic_write, stamped
from numpy_cae.cleanup.words import count
from numpy_cae.cli.shared.summary import UNLIKE, Numbers
from numpy_cae.visible import visible
from numpy_cae.viz.viewer import page_text

HEADINGS = (
    *("file", "poses before and after", "findings", "proposals, not changed", "seconds changed"),
    "frames with a jump",
)
"""What the columns of the table are."""


class Row(NamedTuple):
    """What became of one file, for its line in the terminal and its row in the index."""

    source: Path
    numbers: Numbers
    status: int
    page: Path | None = None
    strip: str = ""

    @property
    def is_clean(self) -> bool:
        """Whether nothing was found in the file and nothing changed, and the model knows such
        motion."""
        numbers = self.numbers
        return not (numbers.findings or numbers.proposals or numbers.changed) and (
            self.status != UNLIKE
        )


def write_index(page: Path, rows: Sequence[Row], unusable: Sequence[str]) -> None:
    """Write the page; `unusable` are the errors of the files that could not be used."""
    clean = [row for row in rows if row.is_clean]
    listed = [row for row in rows if not row.is_clean]
    # Those with most frames that jump first.
    listed.sort(key=lambda row: row.numbers[::-1], reverse=True)
    parts = []
    if unusable:
        parts.append(f"<h2>{count(len(unusable), 'file')} could not be used</h2>")
        items = "".join(f"<li>{escape(visible(error))}</li>" for error in unusable)
        parts.append(f'<ul class="unusable">{items}</ul>')
    if listed:
        parts.append(f"<h2>{count(len(listed), 'file')} with findings or changes</h2>")
        parts.append(_table(page, listed))
    if clean:
        names = "".join(f"<li>{_link(page, row)}</li>" for row in clean)
        summary = f"{count(len(clean), 'file')} without a finding, not changed"
        parts.append(f"<details><summary>{summary}</summary><ul>{names}</ul></details>")
    title = f"{count(len(rows) + len(unusable), 'file')}: before and after"
    text = Template(page_text("index.html")).substitute(title=title, parts="\n".join(parts))
    with atomic_write(page) as temporary:
        temporary.write_text(stamped(text), encoding="utf-8", newline="\n")


def _table(page: Path, rows: Sequence[Row]) -> str:
    head = "".join(f"<th scope=col>{name}</th>" for name in HEADINGS)
    lines = []
    for row in rows:
        numbers = row.numbers
        cells = [
            row.strip,
            f"{numbers.findings}",
            f"{numbers.proposals}",
            f"{numbers.changed:.1f} of {numbers.seconds:.1f}",
            f"{numbers.jumps:.0f} → {numbers.jumps_after:.0f}",
        ]
        texts = []
        for name, cell in zip(HEADINGS[1:], cells, strict=True):
            texts.append(f'<td data-name="{name}">{cell}</td>')
        lines.append(f"<tr><th scope=row>{_link(page, row)}</th>{''.join(texts)}</tr>")
    rows_html = "\n".join(lines)
    return f"<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{rows_html}\n</tbody>\n</table>"


def _link(page: Path, row: Row) -> str:
    """The name of a file, which leads to its page if there is one."""
    name = escape(visible(row.source.name))
    if row.page is None:
        return name
    address = os.fsencode(row.page.relative_to(page.parent).as_posix())
    return f'<a href="{urllib.parse.quote(address)}">{name}</a>'
