"""Results as text, JSON, PNG and one self-contained HTML page with its pictures inside it."""

import base64
import io
import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from string import Template

import numpy as np

from numpy_cae.evaluation.table import Table
from numpy_cae.viz.viewer import fragment, head
from studies.shared.result import Claim, Picture, Result

HERE = Path(__file__).parent
_PAGE = Template((HERE / "page.html").read_text(encoding="utf-8"))


def text(result: Result) -> str:
    """The title, the tables in Markdown's form, the note, the claims and the provenance."""
    claims = [
        f"{status(claim)}: {claim.sentence} Measured: {measured(claim)}" for claim in result.claims
    ]
    made = [f"{name}: {value}" for name, value in result.provenance.items()]
    parts = [result.title, result.about, *(t.text() for t in result.tables), result.note]
    return "\n\n".join(filter(None, [*parts, "\n".join(claims), "\n".join(made)]))


def measured(claim: Claim) -> str:
    """The figures, and those of the opponent."""
    return claim.figures + (f" {claim.opponent}" if claim.opponent else "")


def status(claim: Claim) -> str:
    """The words "confirmed" or "not confirmed"."""
    return "confirmed" if claim.confirmed else "not confirmed"


def data(result: Result) -> dict:
    """Everything but the pictures and the formats, in the types of JSON and NumPy's numbers."""
    tables = [
        {
            "caption": table.caption,
            "header": table.header,
            # JSON has no NaN, the mark of an empty cell.
            "rows": [[None if cell != cell else cell for cell in row] for row in table.rows],
        }
        for table in result.tables
    ]
    claims = [vars(claim) | {"sentence": claim.sentence} for claim in result.claims]
    texts = {name: getattr(result, name) for name in ("title", "about", "note")}
    return texts | {"tables": tables, "claims": claims, "provenance": dict(result.provenance)}


def png(picture: Picture) -> bytes:
    """The figure as PNG."""
    file = io.BytesIO()
    picture.draw().savefig(file, format="png", dpi=110, facecolor="white")
    return file.getvalue()


def best_cells(table: Table) -> set[tuple[int, int]]:
    """Row and column of each value of a table that is marked as the best."""
    compared = defaultdict(list)
    for place, row in enumerate(table.rows):
        group = row[0] if str in map(type, row[1:2]) else str(row[0]).rpartition(": ")[0]
        for column, value in enumerate(row):
            if isinstance(value, float | np.floating) and not np.isnan(value):
                key = place if table.best == "low across" else (column, group)
                compared[key].append((float(value), (place, column)))
    choose = max if table.best == "high" else min
    winners = [choose(values)[0] for values in compared.values()]
    pairs = zip(winners, compared.values(), strict=True)
    return {cell for won, each in pairs for value, cell in each if table.best and value == won}


def page(results: Mapping[str, Result]) -> str:
    """The page's HTML, of results by name; the provenance is folded below each."""
    claims = sum(len(result.claims) for result in results.values())
    confirmed = sum(each.confirmed for each in results.values())
    return _PAGE.substitute(
        count=f"{confirmed} of {claims} claims are confirmed on this data.",
        contents="\n".join(
            f'<li><a href="#{name}">{escape(result.title)}</a> {_counts(result)}</li>'
            for name, result in results.items()
        ),
        sections="\n".join(
            f'<section id="{name}">\n{section(result)}\n</section>'
            for name, result in results.items()
        ),
        viewer=head()
        if any(p.actors for r in results.values() for p in r.figures.values())
        else "",
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
    below = f'<figcaption><a href="#{tables}">The numbers are in the tables</a>.</figcaption>'
    for name, picture in result.figures.items():
        source = f"data:image/png;base64,{base64.b64encode(png(picture)).decode()}"
        label = escape(f"{result.title}: {name}")
        parts.append(f'<figure><img alt="{label}" src="{source}">{below}</figure>')
        if picture.actors:
            viewer = fragment(picture.actors, picture.rate)
            parts.append(f'<figure class="moving">{viewer}</figure>')
    parts.append(f'<div id="{tables}">')
    made = f"<dl>\n{_definitions(result.provenance)}\n</dl>"
    folded = {"What is measured, and how": f"<pre>{escape(result.about)}</pre>"}
    folded["Settings, to repeat the measurements"] = made
    ends = [f"<details><summary>{name}</summary>{html}</details>" for name, html in folded.items()]
    return "\n".join(
        [*parts, *map(_table, result.tables), "</div>", _paragraph(result.note), *ends]
    )


def _definitions(meanings: Mapping[str, str]) -> str:
    return "\n".join(
        f"<dt>{escape(name)}</dt><dd>{escape(meaning)}</dd>" for name, meaning in meanings.items()
    )


def _claim(claim: Claim) -> str:
    return (
        f'<div class="claim"><p>{_verdict(claim.confirmed)} {_inline(claim.sentence)}</p>'
        f"<p>Measured: {_inline(measured(claim))}</p></div>"
    )


def _inline(text: str) -> str:
    """Text as HTML, names between back quotes as code."""
    return re.sub("`([^`]+)`", r"<code>\1</code>", escape(text))


def _paragraph(text: str) -> str:
    return f"<p>{_inline(text)}</p>" if text else ""


def _table(table: Table) -> str:
    best = best_cells(table)

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
