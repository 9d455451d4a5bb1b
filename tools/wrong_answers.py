"""Fifty-one wrong answers to exercises of the lessons, and what their reports say first.

    python -m tools.wrong_answers

docs/wrong_answers.md has the table.

A wrong answer is one of `tools.right_answers`, which are not those from which the named mistakes
are made, with a piece of its text replaced.
"""

import json
from collections.abc import Callable
from pathlib import Path

from numpy_cae.course.catalogue import EXERCISES
from numpy_cae.verify.operations.counterexample import failing_case
from numpy_cae.verify.operations.trial import try_property
from tools.right_answers import answer

SLIPS = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
"""Name of an exercise, slip, number of the module of right answers, the text that is replaced, and
the text in its place."""


def table_row(name: str, slip: str, function: Callable) -> str:
    """The row of the table: which property fails first, and what is said of it."""
    for tested in EXERCISES[name].properties:
        if failing_case(tested, function) is not None:
            outcome = try_property(tested, function)
            problem = outcome.problem.splitlines()[0].replace("|", "\\|")
            return f"| `{name}` | {slip} | {tested.name} | {problem} | {outcome.mistake} |"
    return f"| `{name}` | {slip} | accepted | | |"


if __name__ == "__main__":
    print("| exercise | slip | fails first | what it says | likely |\n|---|---|---|---|---|")
    for name, slip, *replacement in SLIPS:
        print(table_row(name, slip, answer(name, *replacement)), flush=True)
