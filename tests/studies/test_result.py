"""Results as text, as a report, and as pictures."""

import pytest
from matplotlib.figure import Figure

from studies.shared.result import STATEMENTS, Claim, Picture, Result, Table, report, text

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


def test_the_report_begins_with_the_text_of_the_first_result():
    written = report(RESULTS)
    assert written.startswith("# First & foremost\n") and text(RESULT) in written


def test_the_report_names_the_pictures_and_only_pages_that_there_are():
    written = report(RESULTS)
    assert "![First & foremost: one](one.png)" in written and "moving" not in written


def test_the_report_says_why_a_study_has_no_tables():
    assert "Could not be run: no press-ups." in report(RESULTS)


@pytest.mark.parametrize("part", [TABLE.text(), NOTE, "model: m.npz <1>"])
def test_the_text_has_tables_note_and_provenance(part):
    assert part in text(RESULT)


@pytest.mark.parametrize(
    "sentence",
    [
        "sliding, jitter (nearer to the two motions'), nearest pose). Measured: 5 cm.",
        "tenth of the squared error remains, which is 0.316 of the error): takes <of> & more.",
    ],
)
def test_the_text_of_a_claim_has_its_rule_and_its_figures(sentence):
    assert sentence in text(RESULT)


@pytest.mark.parametrize(
    ("key", "fulfilled", "fulfilled_by", "verdict"),
    [
        ("half_recovered", True, "", "confirmed"),
        ("half_recovered", False, "a line", "refuted"),
        ("half_recovered", None, "a line", "no difference"),
        ("half_recovered", True, "a line", "not distinctive"),
        ("sizes", True, "", "by construction"),
        ("sizes", False, "", "refuted"),
    ],
)
def test_the_verdict(key, fulfilled, fulfilled_by, verdict):
    assert Claim(key, fulfilled, "1.", fulfilled_by=fulfilled_by).verdict == verdict


def test_each_statement_has_its_rule_before_it_is_measured():
    for statement in STATEMENTS.values():
        assert {"confirmed if", "opponents", "takes", "seeds", "spread"} < set(statement)
        assert statement["confirmed if"]
