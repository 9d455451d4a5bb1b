"""Grading notebooks: exercise cells with earlier functions given; the marks of a class."""

import ast
import csv
import json
import os
import sys
from pathlib import Path

import pytest

from numpy_cae.cli import main
from numpy_cae.course import catalogue
from numpy_cae.course.catalogue import EXERCISES, LESSONS
from numpy_cae.course.class_tables import write_tables
from numpy_cae.course.marks import by_student, lesson_of, student_id, write_feedback
from numpy_cae.course.notebook import find_lessons, read_notebook
from numpy_cae.verify.grading.student_file import FileReport, grade

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
OWN_CONV1D = "def conv1d(x, w, b):\n    raise ValueError('mine')"
SPEEDS = """
def speeds(positions, rate):
    return rate * np.sqrt((np.diff(positions, axis=0) ** 2).sum(axis=-1))
"""


LOOPS = "def frames_seen(taps, layers):\n    n = 1\n    for _ in range(layers):\n"
LOOPS += "        n = 2 * n + taps - 1\n    return n\n"
WRONG = "def frames_seen(taps, layers):\n    return taps\n"


def hand_in(path: Path, *sources: str) -> Path:
    """Write a notebook with these exercise cells."""
    cell = {"cell_type": "code", "metadata": {"nbgrader": {"solution": True}}}
    cell |= {"execution_count": None, "outputs": []}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"cells": [cell | {"source": source} for source in sources]}))
    return path


def test_operations_of_earlier_lessons_are_given_and_not_graded(tmp_path, forked_grading):
    (tmp_path / "mine.py").write_text("def conv1d(x, w, b):\n    raise ValueError")
    given = "from mine import conv1d, max_pool"
    path = hand_in(tmp_path / "lesson.ipynb", TANH, given + ENCODE, SPEEDS)
    cells = json.loads(path.read_text())["cells"]
    cells.append({"cell_type": "code", "metadata": {}, "source": "import numpy_cae; 1/0"})
    path.write_text(json.dumps({"cells": cells}))
    graded = grade(path, catalogue)
    assert graded.held, str(graded)  # the cell that is no exercise is not run
    points = {report.operation: report.points for report in graded.reports}
    assert points == {name: EXERCISES[name].points for name in ("tanh", "encode_layer", "speeds")}


@pytest.mark.parametrize("tanh", ["def tanh(", "def tanh(x):\n    while True: pass"])
def test_a_mark_does_not_depend_on_an_earlier_exercise_of_the_lesson(
    tanh, tmp_path, monkeypatch, forked_grading
):
    monkeypatch.setattr("numpy_cae.verify.grading.student_file.EXERCISE_SECONDS", 3.0)
    graded = grade(hand_in(tmp_path / "lesson.ipynb", tanh, ENCODE), catalogue, lesson="05")
    points = {report.operation: report.points for report in graded.reports}
    assert points["tanh"] == 0 and points["encode_layer"] == 20, str(graded)


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ((ENCODE,), "name 'tanh' is not defined"),  # of the same lesson
        ((TANH, OWN_CONV1D, ENCODE), "ValueError: mine"),  # the student's own comes first
        (("def encode_layer(",), "cell 1: SyntaxError"),
        ((), "no exercise cell"),
    ],
)
def test_a_failing_cell_gets_its_message(tmp_path, cells, message, forked_grading):
    graded = grade(hand_in(tmp_path / "lesson.ipynb", *cells), catalogue)
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


@pytest.mark.parametrize(
    ("file", "student", "lesson"),
    [
        ("ann/week3/03_convolution_by_hand.ipynb", "ann", ""),
        ("ann_03.ipynb", "ann", "03"),
        ("ann_b_03.py", "ann_b", "03"),
        ("03_ann.py", "ann", ""),
        ("ann.ipynb", "ann", ""),
        ("ann_99.ipynb", "ann_99", ""),
    ],
)
def test_a_student_is_told_by_the_folder_or_the_name(file, student, lesson):
    assert student_id(Path("submitted", file), Path("submitted")) == student
    assert lesson_of(Path(file)) == lesson


def test_marks_and_feedback_of_a_class(tmp_path, capsys):
    submitted, table, feedback = (tmp_path / name for name in ("in", "marks.csv", "feedback"))
    hand_in(submitted / "ann" / "week" / "07_going_deep.ipynb", LOOPS)
    hand_in(submitted / "=cmd()_07.ipynb", WRONG)
    hand_in(submitted / "ben_07.ipynb", WRONG)
    hand_in(submitted / "ben" / "again.ipynb", LOOPS)
    (submitted / "ann" / "week" / "mine.py").write_text("1 / 0")
    (submitted / "eve.ipynb").write_text("{")
    (submitted / "fay.ipynb").symlink_to(submitted / "ben" / "again.ipynb")
    command = ["verify", str(submitted), "--csv", str(table), "--feedback", str(feedback)]
    assert main(command) == 1
    assert "ann: 07_going_deep.ipynb: 10 of 60 points" in capsys.readouterr().out
    with table.open(newline="", encoding="utf-8") as file:
        rows = {row["student"]: row for row in csv.DictReader(file)}
    assert list(rows) == ["maximum", "'=cmd()", "ann", "ben", "eve", "fay"]
    points = [(row["frames_seen"], row["lesson 07"], row["total"]) for row in rows.values()]
    one, none = ("10", "10", "10"), ("", "", "0")
    assert points == [("10", "60", "60"), ("0", "0", "0"), one, one, none, none]
    assert rows["fay"]["problems"] == "it is a link to another file; lesson 07 missing"
    assert {row["possible"] for row in list(rows.values())[1:]} == {"60"}
    assert "stack_loss" in rows["ann"] and rows["ann"]["percent"] == "16.7"
    assert "not a Jupyter notebook" in rows["eve"]["problems"]
    names = sorted(path.stem for path in feedback.glob("*.md"))
    assert names == ["_cmd__.1", "ann", "ben", "eve", "fay"]
    text = (feedback / "_cmd__.1.md").read_text(encoding="utf-8")
    assert "## frames_seen: 0 of 10 points" in text and "ImportError" not in text


def test_nobodys_feedback_is_lost_whatever_the_names(tmp_path):
    students = ["a!", "a__1", "a_.1", "Eve", "eve", os.fsdecode(b"caf\xe9"), "n" * 250, "é" * 125]
    report = FileReport(Path(os.fsdecode(b"\xe9.py")), faults=["\ud800"])
    write_feedback(tmp_path / "feedback", [(student, report) for student in students])
    assert len(list((tmp_path / "feedback").glob("*.md"))) == len(students)
    graded = by_student((student, report) for student in students)
    write_tables(tmp_path / "marks.csv", graded)
    text = (tmp_path / "marks.csv").read_text(encoding="utf-8")
    assert len(text.splitlines()) == 2 + len(students) and "caf\\udce9" in text


MOODLE = "First name,Username,Group\nAnn,ANN,a\nZoe,zoe,b\nSid,sid,b\n"
CANVAS = "Student,ID,SIS Login ID,Section\nAnn,1,ANN,a\nZoe,2,zoe,b\nSid,3,sid,b\n"


@pytest.mark.parametrize("export", [MOODLE, CANVAS])
def test_everyone_of_a_roster_has_a_row_and_a_second_run_keeps_the_first(export, tmp_path, capsys):
    submitted, table, roster = (tmp_path / name for name in ("in", "marks.csv", "class.csv"))
    roster.write_text(export)
    hand_in(submitted / "ann_07.ipynb", WRONG)
    hand_in(submitted / "bob_07.ipynb", LOOPS)
    hand_in(submitted / "sid_05.ipynb", TANH)
    command = ["verify", str(submitted), "--csv", str(table), "--roster", str(roster)]
    assert main([*command, "--due", "2001-01-01"]) == 1

    def rows_of(name: str, key: str) -> dict[str, dict]:
        with (tmp_path / name).open(newline="", encoding="utf-8") as file:
            return {row[key]: row for row in csv.DictReader(file)}

    rows = rows_of("marks.csv", "student")
    assert list(rows) == ["maximum", "ANN", "zoe", "sid", "bob"]
    said = [row["problems"] for row in rows.values()]
    assert said[1:3] == ["lesson 05 missing; ann_07.ipynb late", "nothing handed in"]
    assert "not in the roster" in said[4]
    assert (rows["sid"]["lesson 05"], rows["sid"]["lesson 07"]) == ("10", "")
    imported = rows_of("marks_import.csv", "Username" if export == MOODLE else "SIS Login ID")
    assert imported["ANN"]["Lesson 07"] == imported["zoe"]["Lesson 05"] == "0"
    assert imported["sid"]["Lesson 05"] == "10" and "bob" not in imported
    assert ("Points Possible" in (tmp_path / "marks_import.csv").read_text()) == (export == CANVAS)
    failed = rows_of("marks_statistics.csv", "exercise")["frames_seen"]
    assert (failed["property"], failed["handed in"], failed["failed"]) == ("value", "2", "1")

    hand_in(submitted / "ann_07.ipynb", LOOPS)
    (submitted / "sid_05.ipynb").unlink()
    assert main(command) == 1
    again = rows_of("marks.csv", "student")
    assert again["ANN"]["frames_seen"] == "10" and "late" not in again["ANN"]["problems"]
    assert again["sid"] == rows["sid"] | {"problems": "lesson 07 missing"}
    assert rows_of("marks.1.csv", "student") == rows
    assert main(["verify", str(submitted), "--roster", str(roster)]) == 2
    roster.write_text("Username\n")
    assert main(command) == 2 and "no row of a student" in capsys.readouterr().err


def test_nbgrader_gets_the_points_of_the_command_in_the_check_cells(tmp_path, monkeypatch):
    # An optional module of jsonschema, which nbformat imports, takes seconds to compile a grammar.
    monkeypatch.setitem(sys.modules, "rfc3987_syntax", None)
    nbformat = pytest.importorskip("nbformat")
    from numpy_cae.course.nbgrader import grade_notebook

    (cell,) = read_notebook(hand_in(tmp_path / "07_going_deep.ipynb", LOOPS))["cells"]
    marks = {"nbgrader": {"grade": True, "grade_id": "stack_loss_check", "points": 40}}
    cells = [cell, cell | {"metadata": marks, "source": "1 / 0"}]
    node = nbformat.from_dict({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5})
    graded, _ = grade_notebook(node, {"nbgrader": {"notebook": "07_going_deep"}})
    shown = {}
    for each in graded.cells[1:]:
        text, points = each.outputs
        assert f"{points.data['text/plain']} of " in text.text
        shown[each.metadata["nbgrader"]["grade_id"]] = points.data["text/plain"]
    assert shown.pop("frames_seen_check") == "10"  # whose check cell was deleted
    assert set(shown.values()) == {"0"} and {"stack_loss_check", "stage_inputs_check"} <= set(shown)
