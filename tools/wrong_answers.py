"""Fifty-one wrong answers to exercises of the lessons, and what their reports say first.

    python -m tools.wrong_answers

docs/wrong_answers.md has the table.

A wrong answer is one of the right ones in tests/course/right_styles.txt, which are not those from
which the named mistakes are made, with a piece of its text replaced.
"""

import json
import re
from pathlib import Path

import numpy as np

from numpy_cae.course.catalogue import CATALOGUE, EXERCISES
from numpy_cae.verify.operations.trial import failing_case, try_property

STYLES = re.split(
    r"\n(?=def )",
    (Path(__file__).parents[1] / "tests" / "course" / "right_styles.txt").read_text("utf-8"),
)
SLIPS = json.loads(Path(__file__).with_suffix(".json").read_text("utf-8"))
"""Name of an exercise, slip, number of the right answer in its styles, the text that is replaced,
and the text in its place."""


def wrong_answer(name: str, style: int, old: str, new: str):
    """A right answer with a piece of its text replaced, as a function."""
    source = [each for each in STYLES if each.startswith(f"def {name}(")][style]
    if old not in source:
        raise ValueError(f"{name}: no {old!r}")
    space = {"np": np, **{each: one.solution for each, one in CATALOGUE.items()}}
    exec(source.replace(old, new), space)
    return space[name]


if __name__ == "__main__":
    print("| exercise | slip | fails first | what it says | likely |\n|---|---|---|---|---|")
    for name, slip, *replaced in SLIPS:
        function = wrong_answer(name, *replaced)
        failing = (p for p in EXERCISES[name].properties if failing_case(p, function) is not None)
        first = next(failing, None)
        if first is None:
            print(f"| `{name}` | {slip} | accepted | | |", flush=True)
            continue
        outcome = try_property(first, function)
        what = outcome.problem.splitlines()[0].replace("|", "\\|")
        print(f"| `{name}` | {slip} | {first.name} | {what} | {outcome.mistake} |", flush=True)
