"""A report as one self-contained HTML page with its pictures inside it."""

import base64
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from string import Template

from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.viz.viewer import fragment, head

_PAGE = Template((files("numpy_cae.experiments") / "page.html").read_text(encoding="utf-8"))

TITLE = "Applications of the motion manifold"
INTRODUCTION = (
    "What is measured: whether a network that has learned how people move repairs, fills in, "
    "blends and compares motions, as Learning Motion Manifolds with Convolutional Autoencoders "
    "(Holden, Saito, Komura and Joyce, 2015) says. On what: takes that nothing was trained on or "
    "fitted to. Against what: the strongest simple methods, such as the best linear map, principal "
    "components and the curves of animation programs. An error in cm is the distance of a joint "
    "from its true place. The best value of a column, or of a row, is bold."
)
_LEGEND = json.loads((files("numpy_cae.experiments") / "legend.json").read_text(encoding="utf-8"))
"""Part of a method's name to its meaning."""


def page(
    results: Mapping[str, Result],
    provenance: Mapping[str, str],
    title: str = TITLE,
    introduction: str = INTRODUCTION,
) -> str:
    """The page's HTML, of results by name; `provenance`, what must be known to reproduce the
    figures, is folded at the top."""
    claims = sum(len(result.claims) for result in results.values())
    confirmed = sum(each.confirmed for each in results.values())
    return _PAGE.substitute(
        title=escape(title),
        introduction=escape(introduction),
        count=f"{confirmed} of {claims} claims are confirmed on this data.",
        provenance=_definitions(provenance),
        contents="\n".join(
            f'<li><a href="#{name}">{escape(result.title)}</a> {_counts(result)}</li>'
            for name, result in results.items()
        ),
        legend=_definitions(legend_of(results.values())),
        sections="\n".join(
            f'<section id="{name}">\n{section(result)}\n</section>'
            for name, result in results.items()
        ),
        viewer=head() if any(result.animation for result in results.values()) else "",
    )


def _counts(result: Result) -> str:
    """How many claims of a result are confirmed and how many are not, as coloured signs."""
    numbers = {True: result.confirmed, False: len(result.claims) - result.confirmed}
    return " ".join(_verdict(which, f"{number} ") for which, number in numbers.items() if number)


def _verdict(confirmed: bool, number: str = "") -> str:
    kind, sign = ("yes", "✓ {}confirmed") if confirmed else ("no", "✗ {}not confirmed")
    return f'<span class="verdict {kind}">{sign.format(number)}</span>'


def section(result: Result) -> str:
    """One result as HTML: claims, figure, motions, tables and note."""
    tables = "tables-" + re.sub(r"\W+", "-", result.title.lower())
    parts = [f"<h2>{escape(result.title)}</h2>", *map(_claim, result.claims)]
    if picture := result.png():
        source = f"data:image/png;base64,{base64.b64encode(picture).decode()}"
        label = escape(f"{result.title}: picture")
        below = f'<figcaption><a href="#{tables}">The numbers are in the tables</a>.</figcaption>'
        below = below if result.tables else ""
        parts.append(f'<figure><img alt="{label}" src="{source}">{below}</figure>')
    if moving := result.animation:
        viewer = fragment(moving.actors, moving.rate)
        parts.append(f'<figure class="moving">{viewer}</figure>')
    parts.append(f'<div id="{tables}">')
    return "\n".join([*parts, *map(_table, result.tables), "</div>", _paragraph(result.note)])


def _definitions(meanings: Mapping[str, str]) -> str:
    return "\n".join(
        f"<dt>{escape(name)}</dt><dd>{escape(meaning)}</dd>" for name, meaning in meanings.items()
    )


def _claim(claim: Claim) -> str:
    return (
        f'<div class="claim"><p>{_verdict(claim.confirmed)} {_inline(claim.sentence)}</p>'
        f"<p>Measured: {_inline(claim.figures)}</p></div>"
    )


def _inline(text: str) -> str:
    """Text as HTML, names between back quotes as code."""
    return re.sub("`([^`]+)`", r"<code>\1</code>", escape(text))


def _paragraph(text: str) -> str:
    return f"<p>{_inline(text)}</p>" if text else ""


def _table(table: Table) -> str:
    best = table.best_cells()

    def row(place: int, cells: Sequence[str], tag: str) -> str:
        filled = []
        for column, cell in enumerate(cells):
            text = _inline(cell)
            text = f"<b>{text}</b>" if (place, column) in best else text
            number = column and (tag == "th" or not cell[:1].isalpha())
            filled.append(f"<{tag}{' class=number' if number else ''}>{text}</{tag}>")
        return f"<tr>{''.join(filled)}</tr>"

    head = row(-1, [name or "method" for name in table.header], "th")
    lines = "\n".join(row(place, cells, "td") for place, cells in enumerate(table.cells()))
    html = f"<table>\n<thead>{head}</thead>\n<tbody>\n{lines}\n</tbody></table>"
    return f'{_paragraph(table.caption)}<div class="wide" tabindex="0">{html}</div>'


def legend_of(results: Iterable[Result]) -> dict[str, str]:
    """The meanings of those names that the first columns of the results' tables contain."""
    rows = [row for result in results for table in result.tables for row in table.rows]
    names = {str(row[0]) for row in rows}
    return {
        part: meaning for part, meaning in _LEGEND.items() if any(part in name for name in names)
    }
