"""A page that lists motion files: a row for each, with a strip of poses."""

import os
from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template
from urllib.parse import quote

from numpy_cae.atomic_write import atomic_write
from numpy_cae.visible import visible
from numpy_cae.viz.viewer import page_text


def save_index(
    path: Path, title: str, rows: Sequence[tuple[str, str | None, str, Sequence[str]]]
) -> None:
    """Write a page with a table of files, atomically.

    Parameters
    ----------
    path : path of the .html file
    title : str
    rows : sequence of (name, address, strip, cells)
        Of each file its name, the address of its page or None, a strip as SVG or "", and what is
        said about it.
    """
    lines = []
    for name, address, strip, cells in rows:
        name = escape(visible(name))
        link = f'<a href="{quote(os.fsencode(address))}">{name}</a>' if address else name
        said = "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        lines.append(f"<tr><th scope=row>{link}</th><td>{strip}</td>{said}</tr>")
    page = Template(page_text("index.html"))
    with atomic_write(path) as temporary:
        text = page.substitute(title=escape(visible(title)), rows="\n".join(lines))
        temporary.write_text(text, encoding="utf-8")
