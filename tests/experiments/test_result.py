"""Results as text, JSON, pictures and a page: well formed, self-contained, escaped."""

from html.parser import HTMLParser

import numpy as np
import pytest
from matplotlib.figure import Figure

from numpy_cae.cli.shared.output import plain
from numpy_cae.experiments.page import page, plain_text
from numpy_cae.experiments.result import Claim, Result, Table

HELD = Claim("Motion is <recovered> & well.", True, "3 against 4 cm.")
NOT_CONFIRMED = Claim("It remains valid.", False, "5 cm.")
TABLE = Table("Before <it>:", ["a", "error, cm", "share"], [["x < y", 1.0, 0.5], ["z", 10.25, 2]])
NOTE = "Measured on 2 takes."
RESULT = Result("First & foremost", [TABLE], [HELD, NOT_CONFIRMED], Figure, note=NOTE)
RESULTS = {"one": RESULT, "two": Result("two", [], note="Could not be run: no press-ups.")}


def test_columns_are_aligned_and_numbers_formatted():
    assert TABLE.text().splitlines() == [
        "Before <it>:",
        "",
        "| a     | error, cm | share |",
        "|-------|----------:|------:|",
        "| x < y |      1.00 |  0.50 |",
        "| z     |     10.25 |     2 |",
    ]
    assert TABLE.value("z", "error, cm") == 10.25


def test_formats_by_column_and_empty_cells():
    row = ["z", 0.25, None, np.float32("nan"), np.float64(2), "7, 2"]
    table = Table("", list("abcdef"), [row], ("", ".0%", ".1f", ".1f", ".3f", ""))
    assert table.cells() == [["z", "25%", "", "", "2.000", "7, 2"]]
    assert plain(Result("t", [table]).data())["tables"][0]["rows"] == [
        ["z", 0.25, None, None, 2.0, "7, 2"]
    ]


class Checked(HTMLParser):
    """Every tag that is opened is closed, in order; collects tags, words and links."""

    VOID = ("meta", "img", "br", "link", "input")

    def __init__(self, text: str):
        super().__init__()
        self.open, self.tags, self.words, self.sources = [], [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.sources += [value for key, value in attrs if key in ("src", "href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


@pytest.fixture(scope="module")
def html() -> str:
    return page(RESULTS, {"model": "m.npz <1>", "seed": "0"})


def test_the_page_is_self_contained_and_the_text_has_the_same(html):
    read = Checked(html)
    pictures = [source for source in read.sources if not source.startswith("#")]
    assert len(pictures) == 1 and pictures[0].startswith("data:image/png;base64,iVBOR")
    assert "link" not in read.tags
    assert html.count('id="viewer-modules"') == 0  # nothing moves
    words = "".join(read.words)
    for each in (HELD.sentence, HELD.figures, NOT_CONFIRMED.sentence, "m.npz <1>", RESULT.title):
        assert each in words
    assert "1 of 2 claims are confirmed" in words and RESULT.note in words
    assert "Could not be run: no press-ups." in words
    assert words.count("not confirmed") == 2  # in the summary and at the claim
    assert "<th>a</th><th class=number>error, cm</th>" in html
    assert "<tr><td>x &lt; y</td><td class=number>1.00</td>" in html
    text = plain_text(RESULTS.values(), {"model": "m.npz"})
    for each in ("model: m.npz", TABLE.text(), HELD.text(), NOT_CONFIRMED.text(), "no press-ups"):
        assert each in text
