"""The report's page: well formed, self-contained, escaped, and every figure on it."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import pytest

from numpy_cae.experiments import section as section_room
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.page import page, plain_text, text_to_html
from numpy_cae.experiments.section import Section, run_section
from numpy_cae.experiments.table import text_table

HELD = Finding("Motion is <recovered> & well.", True, "3 against 4 cm.")
NOT_HELD = Finding("It remains valid.", False, "5 cm.")
TABLE = text_table(["a", "error, cm"], [["x < y", "1.0"], ["z", "10.2"]])
SECTIONS = [
    Section(
        "one", "First & foremost", f"Said before:\n\n{TABLE}", [HELD, NOT_HELD], b"PNG", b"GIF"
    ),
    Section("two", "two", failure="no press-ups among the takes"),
]


class Checked(HTMLParser):
    """Every tag that is opened is closed, in order; gathers tags, words and links."""

    VOID = ("meta", "img", "br", "link", "input")

    def __init__(self, text: str):
        super().__init__()
        self.open, self.tags, self.said, self.sources = [], [], [], []
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
        self.said.append(data)


@pytest.fixture(scope="module")
def read() -> Checked:
    return Checked(page(SECTIONS, {"model": "m.npz <1>", "seed": "0"}))


def test_the_page_holds_all_it_shows(read):
    pictures = [source for source in read.sources if not source.startswith("#")]
    assert pictures == ["data:image/png;base64,UE5H", "data:image/gif;base64,R0lG"]
    assert "script" not in read.tags
    assert "link" not in read.tags


def test_claims_verdicts_and_failures_are_on_it(read):
    words = "".join(read.said)
    for said in (HELD.claim, HELD.measured, NOT_HELD.claim, "m.npz <1>", "First & foremost"):
        assert said in words
    assert "1 of 2 claims held" in words
    assert "Could not be run: no press-ups among the takes" in words
    assert words.count("not held") == 2  # in the contents and at the claim


def test_a_table_becomes_a_table():
    html = text_to_html(f"Before <it>,\nand more:\n\n{TABLE}\n\nAfter.")
    assert html.count("<p>") == 2
    assert "Before &lt;it&gt;,<br>and more:" in html
    assert "<th>a</th><th class=number>error, cm</th>" in html
    assert "<tr><td>x &lt; y</td><td class=number>1.0</td></tr>" in html
    Checked(html)


def test_the_text_holds_the_same():
    text = plain_text(SECTIONS, {"model": "m.npz"})
    for said in ("model: m.npz", TABLE, HELD.text(), NOT_HELD.text(), "no press-ups"):
        assert said in text


class Tried:
    """A result without an animation."""

    title = "Tried"

    def text(self):
        return "text"

    def findings(self):
        return [HELD, NOT_HELD]

    def save_picture(self, path):
        Path(path).write_bytes(b"a picture")


def test_a_section_keeps_what_an_experiment_gave(monkeypatch):
    def refuses(manifold, material, seed):
        raise ValueError("nothing is labelled")

    experiments = {"tried": lambda manifold, material, seed: Tried(), "refused": refuses}
    monkeypatch.setattr(section_room, "REPORTED", experiments)
    tried = run_section("tried", None, None)
    assert (tried.picture, tried.gif, tried.held) == (b"a picture", b"", 1)
    assert tried.summary().startswith("tried: 1 of 2 claims held")
    refused = run_section("refused", None, None)
    assert refused.summary() == "refused: could not be run: nothing is labelled"
