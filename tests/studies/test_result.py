"""Results as text, as a report, and as pictures."""

from matplotlib.figure import Figure

from studies.shared.result import Claim, Picture, Result, Table, report, text

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


def test_the_report_has_the_text_and_the_names_of_the_pictures():
    written = report(RESULTS)
    assert written.startswith("# First & foremost\n") and text(RESULT) in written
    assert "![First & foremost: one](one.png)" in written and "moving" not in written
    assert "Could not be run: no press-ups." in written
    printed = text(RESULT)
    assert TABLE.text() in printed and NOTE in printed and "model: m.npz <1>" in printed
    assert "confirmed if it is better on every measure). Measured: 5 cm." in printed
    assert "confirmed if less than half of the error remains): takes <of> & more." in printed
