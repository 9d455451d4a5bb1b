"""Grading of notebooks: the exercise cells, with the functions of earlier lessons given."""

import ast
import json
from pathlib import Path

import pytest

from numpy_cae.course import catalogue
from numpy_cae.course.exercises import EXERCISES, LESSONS
from numpy_cae.course.notebook import find_lessons, read_notebook
from numpy_cae.verify.grading.student_file import grade

ENCODE = """
def encode_layer(x, w, b):
    convolved, convolve_back = conv1d(x, w, b)
    pooled, pool_back = max_pool(convolved)
    y, tanh_back = tanh(pooled)
    return y, lambda dy: convolve_back(pool_back(tanh_back(dy)))
"""
TANH = """
def tanh(x):
    y = np.tanh(x)
    return y, lambda dy: dy * (1 - y * y)
"""
IN_NO_EXERCISE = {"sliced_wasserstein"}  # project 5 of lesson 14
DECODE = "def encode_layer(x, w, b):\n    return decode_layer(x, w, b)"
OWN_CONV1D = "def conv1d(x, w, b):\n    raise ValueError('mine')"
SPEEDS = """
def speeds(positions, rate):
    return rate * np.sqrt((np.diff(positions, axis=0) ** 2).sum(axis=-1))
"""


def notebook(tmp_path, *cells):
    marks = {"nbgrader": {"solution": True}}
    written = [{"cell_type": "code", "metadata": marks, "source": source} for source in cells]
    path = tmp_path / "lesson.ipynb"
    path.write_text(json.dumps({"cells": written}), encoding="utf-8")
    return path


def test_operations_of_earlier_lessons_are_given_and_not_graded(tmp_path):
    (tmp_path / "mine.py").write_text("def conv1d(x, w, b):\n    raise ValueError")
    path = notebook(tmp_path, TANH, "from mine import conv1d, max_pool" + ENCODE, SPEEDS)
    cells = json.loads(path.read_text())["cells"]
    cells.append({"cell_type": "code", "metadata": {}, "source": "import numpy_cae; 1/0"})
    path.write_text(json.dumps({"cells": cells}))
    graded = grade(path, catalogue)
    assert graded.held, str(graded)  # the cell that is no exercise is not run
    points = {report.operation: report.points for report in graded.reports}
    assert points == {name: EXERCISES[name].points for name in ("tanh", "encode_layer", "speeds")}


@pytest.mark.parametrize("tanh", ["def tanh(", "def tanh(x):\n    while True: pass"])
def test_a_mark_does_not_depend_on_an_earlier_exercise_of_the_lesson(tanh, tmp_path, monkeypatch):
    monkeypatch.setattr("numpy_cae.verify.grading.student_file.EXERCISE_SECONDS", 3.0)
    graded = grade(notebook(tmp_path, tanh, ENCODE), catalogue, lesson="05")
    points = {report.operation: report.points for report in graded.reports}
    assert points["tanh"] == 0 and points["encode_layer"] == 20


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ((ENCODE,), "name 'tanh' is not defined"),  # of the same lesson
        (("from mine import tanh" + ENCODE,), "cannot import name 'tanh'"),
        ((DECODE,), "name 'decode_layer' is not defined"),  # of the same lesson, later
        ((TANH, OWN_CONV1D, ENCODE), "ValueError: mine"),  # the student's own comes first
        (("def encode_layer(",), "cell 1: SyntaxError"),
        ((), "no exercise cell"),
    ],
)
def test_a_failing_cell_gets_its_message(tmp_path, cells, message):
    graded = grade(notebook(tmp_path, *cells), catalogue)
    assert message in str(graded) and not graded.held


@pytest.mark.parametrize(
    "path", find_lessons(Path(__file__).parents[2] / "lessons"), ids=lambda path: path.stem
)
def test_every_operation_that_a_lesson_imports_is_given(path):
    imported = {
        alias.name
        for cell in read_notebook(path)["cells"]
        if cell["cell_type"] == "code"
        for node in ast.walk(ast.parse(cell["source"].removeprefix("%matplotlib inline")))
        if isinstance(node, ast.ImportFrom) and node.module in ("numpy_cae.ops", "mine")
        for alias in node.names
    }
    given = {name for exercise in LESSONS[path.name[:2]] for name in exercise.given}
    assert imported - IN_NO_EXERCISE <= given
