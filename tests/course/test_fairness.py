"""Right answers get full marks in any style, lessons need earlier ones only, ours is never graded.

`tools.right_answers` has two further answers to each exercise, as students hand them in. The key is
`numpy_cae.course.solutions`.
"""

import ast
import inspect
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from submissions import CLASSES, hand_in

from numpy_cae.course import catalogue
from numpy_cae.course.catalogue import CATALOGUE, EXERCISES, LESSONS
from numpy_cae.course.mine_file import run_mine
from numpy_cae.course.notebooks import find_lessons, number_of, read_notebook, student_copy
from numpy_cae.course.submitted_file import is_exercise
from numpy_cae.verify.grading.student_file import grade
from numpy_cae.verify.operations.counterexample import failure
from tools.execute_lessons import mine_before
from tools.right_answers import RIGHT_ANSWERS, answer

NOTEBOOKS = find_lessons(Path(__file__).parents[2] / "lessons")


def statements(source: str) -> str:
    """The functions of a source, without their docstrings."""
    functions = [node for node in ast.parse(source).body if isinstance(node, ast.FunctionDef)]
    for function in functions:
        del function.body[: ast.get_docstring(function) is not None]
    return "\n".join(map(ast.unparse, functions))


@pytest.mark.parametrize("share", [12, pytest.param(1, marks=pytest.mark.lessons)])
@pytest.mark.parametrize("name", EXERCISES)
def test_every_exercise_is_solved_in_three_styles(name, share):
    """By default each style has every other case of a few."""
    few = [replace(p, examples=max(1, p.examples // share)) for p in EXERCISES[name].properties]
    tried = [(stated, case) for stated in few for case in stated.cases()]
    for number in range(len(RIGHT_ANSWERS)):  # the key, the third, is in test_lessons
        function = answer(name, number)
        part = tried if share == 1 else tried[number::2]
        assert all(failure(stated, function, case) is None for stated, case in part), number


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


@pytest.mark.parametrize("own", CLASSES["never graded"])
def test_the_students_function_is_graded_and_never_ours(own, tmp_path, forked_grading):
    (tmp_path / "mine.py").write_text("from numpy_cae.ops import tanh\n")
    graded = grade(hand_in(tmp_path / "05_one_layer.ipynb", own), catalogue, lesson="05")
    assert graded.points == 0, str(graded)
