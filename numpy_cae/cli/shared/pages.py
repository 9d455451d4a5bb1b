"""The pages of `repair` and `fill`: before and after of one file, and an index of several."""

import os
import urllib.parse
from collections.abc import Sequence
from html import escape
from pathlib import Path
from string import Template
from typing import Any, NamedTuple

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.motion import Motion
from numpy_cae.repair import Repaired
from numpy_cae.repair.repaired import count
from numpy_cae.visible import visible
from numpy_cae.viz import before_and_after, save_viewer, strip_svg
from numpy_cae.viz.viewer import page_text


class Row(NamedTuple):
    """What became of one file, for its line in the terminal and its row in the index.

    The numbers are: findings, seconds that were changed, seconds, frames with a jump before and
    after; `said` are these in words.
    """

    source: Path
    numbers: tuple[float, ...]
    said: str
    status: int
    page: Path | None = None
    strip: str = ""


def write_page(page: Path, motion: Motion, repaired: Repaired, **shown: Any) -> str:
    """Write the page of a motion before and after, with `shown` as in `save_viewer`; return the
    strip of its row in the index."""
    actors = before_and_after(motion, repaired.motion, rig_of(motion).joints)
    entries = [finding.to_json() for finding in repaired.listed()]
    save_viewer(actors, page, motion.rate, overlaid=True, findings=entries, **shown)
    changed = np.flatnonzero(repaired.touched.any(axis=1)) + len(motion) - len(repaired.motion)
    return strip_svg(actors, changed)


def write_index(page: Path, rows: Sequence[Row]) -> None:
    """Write the page that lists all files, those with most frames that jump first."""
    lines = []
    for row in sorted(rows, key=lambda row: row.numbers[::-1], reverse=True):
        name = escape(visible(row.source.name))
        if row.page:
            address = os.fsencode(row.page.relative_to(page.parent).as_posix())
            name = f'<a href="{urllib.parse.quote(address)}">{name}</a>'
        said = "".join(f"<td>{escape(cell)}</td>" for cell in row.said.split(", "))
        lines.append(f"<tr><th scope=row>{name}</th><td>{row.strip}</td>{said}</tr>")
    title = f"{count(len(rows), 'file')}: before and after"
    text = Template(page_text("index.html")).substitute(title=title, rows="\n".join(lines))
    with atomic_write(page) as temporary:
        temporary.write_text(text, encoding="utf-8")
