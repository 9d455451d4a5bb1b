"""A report as one self-contained HTML page with its pictures inside it."""

import base64
import json
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from string import Template

from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.viz.viewer import fragment, head

_PAGE = Template((files("numpy_cae.experiments") / "page.html").read_text(encoding="utf-8"))

TITLE = "Applications of the motion manifold"
INTRODUCTION = (
    "The claims of holden2015, Learning Motion Manifolds with Convolutional Autoencoders (Holden, "
    "Saito, Komura and Joyce, 2015), and comparisons that the paper does not make, measured on "
    "takes that nothing was trained on or fitted to."
)
_LEGEND = json.loads((files("numpy_cae.experiments") / "legend.json").read_text(encoding="utf-8"))
"""Part of a method's name to its meaning."""


def page(results: Mapping[str, Result], provenance: Mapping[str, str]) -> str:
    """The page's HTML, of results by name; `provenance`, what must be known to reproduce the
    figures, is at the top."""
    links = {
        name: f'<a href="#{name}">{escape(result.title)}</a>' for name, result in results.items()
    }
    claims = [(links[name], claim) for name, result in results.items() for claim in result.claims]
    ordered = sorted(claims, key=lambda pair: not pair[1].confirmed)
    return _PAGE.substitute(
        title=escape(TITLE),
        introduction=escape(INTRODUCTION),
        count=f"{sum(each.confirmed for each in results.values())} of {len(claims)} claims are "
        "confirmed on this data.",
        provenance=_definitions(provenance),
        contents="\n".join(f"<li>{link}</li>" for link in links.values()),
        claims="\n".join(
            f"<li>{_status(claim)} {escape(claim.sentence)} <small>{link}</small></li>"
            for link, claim in ordered
        ),
        legend=_definitions(legend_of(results.values())),
        sections="\n".join(
            f'<section id="{name}">\n{section(result)}\n</section>'
            for name, result in results.items()
        ),
        viewer=head() if any(result.animation for result in results.values()) else "",
    )


def section(result: Result) -> str:
    """One result as HTML: claims, figure, motions, tables and note."""
    parts = [f"<h2>{escape(result.title)}</h2>", *map(_claim, result.claims)]
    if picture := result.png():
        source = f"data:image/png;base64,{base64.b64encode(picture).decode()}"
        label = escape(f"{result.title}: picture")
        parts.append(f'<figure><img alt="{label}" src="{source}"></figure>')
    if moving := result.animation:
        parts.append(f"<figure>{fragment(moving.actors, moving.rate)}</figure>")
    return "\n".join([*parts, *map(_table, result.tables), _paragraph(result.note)])


def _definitions(meanings: Mapping[str, str]) -> str:
    return "\n".join(
        f"<dt>{escape(name)}</dt><dd>{escape(meaning)}</dd>" for name, meaning in meanings.items()
    )


def _status(claim: Claim) -> str:
    colour = "yes" if claim.confirmed else "no"
    return f'<span class="verdict {colour}">{claim.status}</span>'


def _claim(claim: Claim) -> str:
    return (
        f'<div class="claim"><p>{_status(claim)} {escape(claim.sentence)}</p>'
        f"<p>Measured: {escape(claim.figures)}</p></div>"
    )


def _paragraph(text: str) -> str:
    return f"<p>{escape(text)}</p>" if text else ""


def _table(table: Table) -> str:
    def row(cells: Sequence[str], tag: str) -> str:
        filled = [
            f"<{tag}{' class=number' if column else ''}>{escape(cell)}</{tag}>"
            for column, cell in enumerate(cells)
        ]
        return f"<tr>{''.join(filled)}</tr>"

    head = row(table.header, "th")
    lines = "\n".join(row(cells, "td") for cells in table.cells())
    html = f"<table>\n<thead>{head}</thead>\n<tbody>\n{lines}\n</tbody></table>"
    return f'{_paragraph(table.caption)}<div class="wide">{html}</div>'


def legend_of(results: Iterable[Result]) -> dict[str, str]:
    """The meanings of those names that the first columns of the results' tables contain."""
    rows = [row for result in results for table in result.tables for row in table.rows]
    names = {str(row[0]) for row in rows}
    return {
        part: meaning for part, meaning in _LEGEND.items() if any(part in name for name in names)
    }
