"""Results as text, pictures and a page: well formed, self-contained, escaped."""

import re
from html import escape

from matplotlib.figure import Figure

from studies.shared.render import best_cells, page, text
from studies.shared.result import Claim, Picture, Result, Table

CLAIMS = [
    Claim("half_recovered", True, "3 against 4 cm.", "takes <of> & more"),
    Claim("interpolation_is_valid", False, "5 cm."),
]
TABLE = Table("Before <it>:", ["a", "error, cm", "share"], [["x < y", 1.0, 0.5], ["z", 10.25, 2]])
NOTE = "Measured on 2 takes."
MADE = {"model": "m.npz <1>", "seed": "0"}
FIGURES = {"one": Picture(Figure)}
RESULT = Result("First & foremost", [TABLE], CLAIMS, FIGURES, NOTE, "How.", MADE)
RESULTS = {"one": RESULT, "two": Result("two", [], note="Could not be run: no press-ups.")}


def test_the_best_of_a_column_or_of_a_row_is_marked():
    rows = [["a: x", 3.0, 1.0], ["a: y", 2.0, 4.0], ["b: x", 9.0, None]]
    marked = {
        best: best_cells(Table("", ["", "cm", "share"], rows, best=best))
        for best in ("", "low", "high", "low across")
    }
    assert marked == {
        "": set(),
        "low": {(1, 1), (0, 2), (2, 1)},
        "high": {(0, 1), (1, 2), (2, 1)},
        "low across": {(0, 2), (1, 1), (2, 1)},
    }
    html = page({"a": Result("A `name`", [Table("", ["", "cm", "share"], rows, best="low")])})
    assert "<th>method</th>" in html and html.count("<td class=number><b>") == 3


def test_the_page_is_self_contained_and_the_text_has_the_same():
    html = page(RESULTS)
    opened = []
    for closing, tag in re.findall(r"<(/?)(\w+)", html):
        if closing:
            assert opened.pop() == tag
        elif tag not in ("meta", "img", "br", "link", "input"):
            opened.append(tag)
    assert opened == []
    links = re.findall(r'(?:src|href)="([^#][^"]*)"', html)
    assert len(links) == 1 and links[0].startswith("data:image/png;base64,iVBOR")
    assert html.count('id="viewer-modules"') == 0  # nothing moves
    for shown in (CLAIMS[0].sentence, CLAIMS[1].figures, NOTE, "m.npz <1>", RESULT.title):
        assert escape(shown) in html
    assert "1 of 2 claims are confirmed" in html and "Could not be run: no press-ups." in html
    assert html.count("✗ not confirmed") == html.count(escape(CLAIMS[1].sentence)) == 1
    assert "<th>a</th><th class=number>error, cm</th>" in html
    assert "<tr><td>x &lt; y</td><td class=number>1.00</td>" in html
    printed = text(RESULT)
    assert TABLE.text() in printed and NOTE in printed and "model: m.npz <1>" in printed
    assert "confirmed if it is better on every measure). Measured: 5 cm." in printed
    assert "confirmed if less than half of the error remains): takes <of> & more." in printed
