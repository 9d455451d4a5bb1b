"""Fifty-one wrong answers to exercises of the lessons, and what their reports say first.

    python -m tools.wrong_answers

docs/tables/wrong_answers.csv is its output.

A wrong answer is one of `tools.right_answers`, which are not those from which the named mistakes
are made, with a piece of its text replaced.
"""

import csv
import json
import sys
from collections.abc import Callable
from pathlib import Path

from numpy_cae.course.catalogue import EXERCISES
from numpy_cae.verify.operations.counterexample import failing_case
from numpy_cae.verify.operations.trial import try_property
from tools.right_answers import answer

SLIPS = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
"""Name of an exercise, slip, number of the module of right answers, the text that is replaced, and
the text in its place."""


def row_of(name: str, slip: str, function: Callable) -> list[str]:
    """The row of the list: which property fails first, and what is said of it."""
    for tested in EXERCISES[name].properties:
        if failing_case(tested, function) is not None:
            outcome = try_property(tested, function)
            return [name, slip, tested.name, outcome.problem.splitlines()[0], outcome.mistake]
    return [name, slip, "accepted", "", ""]


if __name__ == "__main__":
    output = csv.writer(sys.stdout, lineterminator="\n")
    output.writerow(["exercise", "slip", "fails first", "what it says", "likely"])
    for name, slip, *replacement in SLIPS:
        output.writerow(row_of(name, slip, answer(name, *replacement)))
