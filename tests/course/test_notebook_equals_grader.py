"""What the notebook says of an answer is what the grader says, for every known answer."""

import linecache
from inspect import getsource

import numpy as np
import pytest
from submissions import hand_in

from numpy_cae import course
from numpy_cae.course import catalogue
from numpy_cae.course.catalogue import EXERCISES, LESSONS
from numpy_cae.verify.grading.student_file import grade
from tools.right_answers import RIGHT_ANSWERS
from tools.wrong_answers import SLIPS

LESSON_OF = {each.name: number for number, exercises in LESSONS.items() for each in exercises}
LESSON_OF.setdefault("sliced_wasserstein", "11")
RIGHT = [(name, number, "", "") for name in EXERCISES for number in range(len(RIGHT_ANSWERS))]
WRONG = [(name, number, old, new) for name, _, number, old, new in SLIPS]
KNOWN = [*RIGHT, *WRONG]
QUICK = 40
"""By default one of so many answers is tried, and all with the marker `lessons`."""


def source_of(name: str, number: int, old: str, new: str) -> str:
    """The cell of a known answer."""
    source = getsource(getattr(RIGHT_ANSWERS[number], name))
    return source.replace(old, new) if old else source


def define_in_cell(name: str, source: str):
    """A function as a notebook's kernel has it, which knows every function of the package."""
    file = f"<cell {len(linecache.cache)}>"
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)
    space = {"np": np, **{key: exercise.solution for key, exercise in catalogue.CATALOGUE.items()}}
    space["__name__"] = "__main__"
    exec(compile(source, file, "exec"), space)
    return space[name]


@pytest.fixture
def most_cases():
    """All, as in the notebook."""
    return None


def marked(place: int, known: tuple):
    marks = [pytest.mark.lessons] if place % QUICK else []
    return pytest.param(*known, marks=marks, id=f"{known[0]}-{place}")


@pytest.mark.parametrize(
    ("name", "number", "old", "new"), [marked(place, known) for place, known in enumerate(KNOWN)]
)
def test_points_in_the_notebook_are_those_of_the_grader(
    name, number, old, new, tmp_path, forked_grading, capsys
):
    source = source_of(name, number, old, new)
    graded = grade(hand_in(tmp_path / "a.ipynb", source), catalogue, lesson=LESSON_OF[name])
    (of_grader,) = [report for report in graded.reports if report.operation == name]
    of_notebook = course.report(name, define_in_cell(name, source))
    assert of_notebook.points == of_grader.points, str(of_grader)
