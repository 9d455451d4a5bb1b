"""Right answers get full marks in any style, lessons need earlier ones only, ours is never graded.

`right_styles.txt` has two further answers to each exercise, as students hand them in: unlike the
key, they are text. The key is `numpy_cae.course.solutions`.
"""

import ast
import inspect
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_grading_and_marks import DATA, hand_in

from numpy_cae.course import catalogue
from numpy_cae.course.catalogue import CATALOGUE, EXERCISES, LESSONS
from numpy_cae.course.cells import run_mine
from numpy_cae.course.notebooks import find_lessons, number_of, read_notebook, student_copy
from numpy_cae.verify.grading.student_file import grade
from numpy_cae.verify.grading.submission import is_exercise
from numpy_cae.verify.operations.trial import failure
from tools.execute_lessons import mine_before

NOTEBOOKS = find_lessons(Path(__file__).parents[2] / "lessons")
STYLES = re.split(r"\n(?=def )", Path(__file__).with_name("right_styles.txt").read_text("utf-8"))
SPACE = {"np": np, **{name: each.solution for name, each in CATALOGUE.items()}}


def statements(source: str) -> str:
    """The functions of a source, without their docstrings."""
    functions = [node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)]
    for function in functions:
        del function.body[: ast.get_docstring(function) is not None]
    return "\n".join(map(ast.unparse, functions))


@pytest.mark.parametrize("share", [8, pytest.param(1, marks=pytest.mark.lessons)])
@pytest.mark.parametrize("name", EXERCISES)
def test_every_exercise_is_solved_in_three_styles(name, share):
    """By default each style has every other case of a few."""
    styles = [source for source in STYLES if source.startswith(f"def {name}(")]
    assert len(styles) == 2  # the key, the third, is graded in test_lessons
    few = [replace(p, examples=max(1, p.examples // share)) for p in EXERCISES[name].properties]
    tried = [(stated, case) for stated in few for case in stated.cases()]
    for number, source in enumerate(styles):
        space = dict(SPACE)
        exec(source, space)
        part = tried if share == 1 else tried[number::2]
        assert all(failure(stated, space[name], case) is None for stated, case in part), source


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_lesson_is_solved_with_the_solutions_of_earlier_ones_alone(path):
    space = {"np": np, **{n: o.solution for n, o in CATALOGUE.items() if n not in EXERCISES}}
    space |= run_mine(mine_before(path))
    for cell in filter(is_exercise, read_notebook(path)["cells"]):
        exec(cell["source"], space)
        key = CATALOGUE[cell["metadata"]["nbgrader"]["grade_id"]].solution
        if key.__module__.startswith("numpy_cae.course.solutions."):
            assert statements(cell["source"]) == statements(inspect.getsource(key))
    for each in LESSONS[number_of(path)]:  # one case of each property uses all names
        for stated in each.properties:
            assert failure(stated, space[each.name], stated.cases()[0]) is None, stated
    stubs = filter(is_exercise, student_copy(read_notebook(path))["cells"])
    assert all(stub["source"].count("raise NotImplementedError") == 1 for stub in stubs)


@pytest.mark.parametrize("own", DATA["never graded"])
def test_the_students_function_is_graded_and_never_ours(own, tmp_path, forked_grading):
    (tmp_path / "mine.py").write_text("from numpy_cae.ops import tanh\n")
    graded = grade(hand_in(tmp_path / "05_one_layer.ipynb", own), catalogue, lesson="05")
    assert graded.points == 0, str(graded)
