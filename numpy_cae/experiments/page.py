"""The report as one self-contained page: plain HTML, a little CSS, pictures inside it."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from html import escape
from importlib.resources import files
from itertools import groupby
from string import Template

from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.section import Section

_PAGE = Template((files("numpy_cae.experiments") / "page.html").read_text(encoding="utf-8"))

TITLE = "What the manifold is for"
INTRODUCTION = (
    "Each claim of holden2015, Learning Motion Manifolds with Convolutional Autoencoders (Holden, "
    "Saito, Komura and Joyce, 2015), and comparisons that the paper does not make, measured on "
    "takes that nothing was trained on or fitted to."
)


def page(
    sections: Sequence[Section],
    provenance: Mapping[str, str],
    title: str = TITLE,
    introduction: str = INTRODUCTION,
) -> str:
    """The page's HTML.

    Parameters
    ----------
    sections : sequence of Section
    provenance : mapping of str to str
        How the figures came about, for the top of the page.
    title, introduction : str
        What the page is about, at its very top.
    """
    findings = [finding for section in sections for finding in section.findings or []]
    held = sum(finding.held for finding in findings)
    return _PAGE.substitute(
        title=escape(title),
        introduction=escape(introduction),
        count=f"{held} of {len(findings)} claims held on this data.",
        provenance="\n".join(
            f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in provenance.items()
        ),
        contents="\n".join(_entry(section) for section in sections),
        sections="\n".join(_section(section) for section in sections),
    )


def plain_text(sections: Sequence[Section], provenance: Mapping[str, str]) -> str:
    """The same for a terminal: provenance, tables and findings."""
    lines = [f"{name}: {value}" for name, value in provenance.items()]
    for section in sections:
        lines += ["", "", section.title, "=" * len(section.title), ""]
        lines += [f"Could not be run: {section.failure}"] if section.failure else [section.text]
        lines += ["", *(finding.text() for finding in section.findings or [])]
    return "\n".join(lines) + "\n"


def _entry(section: Section) -> str:
    verdicts = " ".join(_verdict(finding.held) for finding in section.findings or [])
    if section.failure:
        verdicts = '<span class="verdict none">not run</span>'
    return f'<li><a href="#{section.name}">{escape(section.title)}</a> {verdicts}</li>'


def _section(section: Section) -> str:
    parts = [f'<section id="{section.name}">', f"<h2>{escape(section.title)}</h2>"]
    if section.failure:
        parts.append(f"<p>Could not be run: {escape(section.failure)}.</p>")
    parts += [_claim(finding) for finding in section.findings or []]
    parts += _figure(section.picture, "image/png", f"{section.title}: picture")
    parts += _figure(section.gif, "image/gif", f"{section.title}: animation")
    parts += [text_to_html(section.text), f"<p><small>{section.seconds:.0f} s</small></p>"]
    return "\n".join([*parts, "</section>"])


def _verdict(held: bool) -> str:
    return (
        f'<span class="verdict {"yes" if held else "no"}">{"held" if held else "not held"}</span>'
    )


def _claim(finding: Finding) -> str:
    return (
        f'<div class="claim"><p>{_verdict(finding.held)} {escape(finding.claim)}</p>'
        f"<p>Measured: {escape(finding.measured)}</p></div>"
    )


def _figure(content: bytes, kind: str, label: str) -> list[str]:
    if not content:
        return []
    source = f"data:{kind};base64,{base64.b64encode(content).decode()}"
    return [f'<figure><img alt="{escape(label)}" src="{source}"></figure>']


def text_to_html(text: str) -> str:
    """Paragraphs, and tables in Markdown's form, as HTML.

    Lines that begin with "|" and follow each other are a table; of its second line, colons at the
    right make a column of numbers.
    """
    parts = []
    for kind, group in groupby(text.splitlines(), key=_kind):
        lines = list(group)
        if kind == "table":
            parts.append(_table([_cells(line) for line in lines]))
        elif kind == "words":
            parts.append(f"<p>{'<br>'.join(escape(line) for line in lines)}</p>")
    return "\n".join(parts)


def _kind(line: str) -> str:
    return "table" if line.startswith("|") else "words" if line.strip() else "gap"


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def _table(rows: list[list[str]]) -> str:
    header, rule, *body = rows
    numbers = [cell.endswith(":") for cell in rule]

    def row(cells: list[str], tag: str) -> str:
        filled = [
            f"<{tag}{' class=number' if number else ''}>{escape(cell)}</{tag}>"
            for cell, number in zip(cells, numbers, strict=True)
        ]
        return f"<tr>{''.join(filled)}</tr>"

    head, lines = row(header, "th"), "\n".join(row(cells, "td") for cells in body)
    table = f"<table>\n<thead>{head}</thead>\n<tbody>\n{lines}\n</tbody></table>"
    return f'<div class="wide">{table}</div>'
