"""Grading notebooks: exercise cells with earlier functions given; the marks of a class."""

import ast
import csv
import json
import os
import sys
import zipfile
from pathlib import Path, PurePosixPath

import pytest
from submissions import (
    CLASSES,
    ENCODE,
    FRAMES_SEEN,
    LESSON_FILES,
    RAISING_CONV1D,
    SPEEDS,
    TANH,
    WRONG_FRAMES_SEEN,
    hand_in,
)

from numpy_cae.cli import main
from numpy_cae.course import catalogue
from numpy_cae.course.catalogue import EXERCISES, LESSONS
from numpy_cae.course.marks import handed_in
from numpy_cae.course.marks.class_marks import ClassMarks
from numpy_cae.course.marks.feedback_files import write_feedback
from numpy_cae.course.marks.handed_in import HandedIn, find_files, hand_in_by_place
from numpy_cae.course.marks.roster import read_roster
from numpy_cae.course.notebooks import find_lessons, number_of, read_notebook, student_copy
from numpy_cae.verify.grading.student_file import FileReport, grade
from numpy_cae.visible import visible

IN_NO_EXERCISE = {"sliced_wasserstein"}  # project 5 of lesson 14


def rows_of(path: Path) -> dict[str, dict]:
    with path.open(newline="", encoding="utf-8") as file:
        return {next(iter(row.values())): row for row in csv.DictReader(file)}


def test_operations_of_earlier_lessons_are_given_and_not_graded(tmp_path, forked_grading):
    (tmp_path / "mine.py").write_text("def conv1d(x, w, b):\n    raise ValueError")
    given = "from mine import conv1d, max_pool\n"
    path = hand_in(tmp_path / "lesson.ipynb", TANH, given + ENCODE, SPEEDS)
    cells = json.loads(path.read_text())["cells"]
    cells.append({"cell_type": "code", "metadata": {}, "source": "import numpy_cae; 1/0"})
    path.write_text(json.dumps({"cells": cells}))
    graded = grade(path, catalogue)
    assert graded.held, str(graded)  # the cell that is no exercise is not run
    points = {report.operation: report.points for report in graded.reports}
    assert points == {name: EXERCISES[name].points for name in ("tanh", "encode_layer", "speeds")}


@pytest.mark.parametrize(("tanh", "earned"), CLASSES["tanh and its points"])
def test_a_right_value_has_its_points_and_earlier_exercises_do_not_matter(
    tanh, earned, tmp_path, forked_grading
):
    path = hand_in(tmp_path / "lesson.ipynb", tanh, ENCODE)
    graded = grade(path, catalogue, lesson="05")
    points = {report.operation: report.points for report in graded.reports}
    assert points["tanh"] == earned and points["encode_layer"] == 20, str(graded)


@pytest.mark.parametrize(
    ("cells", "message"),
    [
        ((ENCODE,), "name 'tanh' is not defined"),  # of the same lesson
        ((TANH, RAISING_CONV1D, ENCODE), "ValueError: mine"),  # the student's own comes first
        (("def encode_layer(",), "cell 1: SyntaxError"),
        ((), "no exercise cell"),
    ],
)
def test_a_failing_cell_gets_its_message(tmp_path, cells, message, forked_grading):
    graded = grade(hand_in(tmp_path / "lesson.ipynb", *cells), catalogue)
    assert message in str(graded) and not graded.held


def answered_below(cells, place):
    cells.append({"cell_type": "code", "metadata": {}, "source": FRAMES_SEEN})


def without_metadata(cells, place):
    cells[place]["source"] = FRAMES_SEEN
    for cell in cells:
        cell["metadata"] = {}


def copied(cells, place):
    cells.insert(place, cells[place] | {"source": FRAMES_SEEN})


@pytest.mark.parametrize("change", [answered_below, without_metadata, copied])
def test_what_the_notebook_accepts_the_grader_accepts(change, tmp_path, forked_grading):
    notebook = student_copy(read_notebook(LESSON_FILES / "07_going_deep.ipynb"))
    ids = [cell["metadata"].get("nbgrader", {}).get("grade_id") for cell in notebook["cells"]]
    change(notebook["cells"], ids.index("frames_seen"))
    path = tmp_path / "07_going_deep.ipynb"
    path.write_text(json.dumps(notebook))
    graded = grade(path, catalogue)
    assert (graded.points, graded.possible, graded.faults) == (10, 60, [])
    assert graded.copied == ("frames_seen",) * (change is copied)


EXPORT = """#!/usr/bin/env python
# coding: utf-8

# # Going deep

# In[ ]:


get_ipython().run_line_magic('matplotlib', 'inline')
from numpy_cae import course
course.load_mine()


# In[2]:


get_ipython().run_cell_magic('time', '', {cell!r})


# In[3]:


course.report("frames_seen", frames_seen)
"""


def test_a_script_that_jupyter_has_made_is_graded(tmp_path, forked_grading):
    path = tmp_path / "07_going_deep.py"
    path.write_text(EXPORT.format(cell=FRAMES_SEEN))
    graded = grade(path, catalogue)
    assert (graded.points, graded.possible, graded.faults) == (10, 60, [])


def test_a_script_of_vs_code_is_graded(tmp_path, forked_grading):
    path = tmp_path / "work.py"
    cells = ["", "import numpy_cae", FRAMES_SEEN, 'course.report("frames_seen", frames_seen)']
    path.write_text("\n# %%\n".join(cells))
    graded = grade(path, catalogue)
    assert (graded.points, graded.possible, graded.faults) == (10, 60, [])


ROTATES_BY_SCIPY = """
def turn_about_y(vectors, angles):
    from scipy.spatial.transform import Rotation

    turned = np.empty(np.shape(vectors))
    for frame, angle in enumerate(angles):
        turned[frame] = Rotation.from_rotvec([0.0, angle, 0.0]).apply(vectors[frame])
    return turned
"""


def test_a_right_answer_that_asks_for_writable_arrays_passes(tmp_path, forked_grading):
    path = hand_in(tmp_path / "02_a.ipynb", ROTATES_BY_SCIPY)
    (report,) = [r for r in grade(path, catalogue).reports if r.operation == "turn_about_y"]
    assert report.held, str(report)


@pytest.mark.parametrize("path", find_lessons(LESSON_FILES), ids=lambda path: path.stem)
def test_every_operation_that_a_lesson_imports_is_given(path):
    imported = {
        alias.name
        for cell in read_notebook(path)["cells"]
        if cell["cell_type"] == "code"
        for node in ast.walk(ast.parse(cell["source"].removeprefix("%matplotlib inline")))
        if isinstance(node, ast.ImportFrom) and node.module in ("numpy_cae.ops", "mine")
        for alias in node.names
    }
    given = {name for exercise in LESSONS[number_of(path)] for name in exercise.provided}
    assert imported - IN_NO_EXERCISE <= given


@pytest.mark.parametrize(("place", "student", "names", "lesson"), CLASSES["places"])
def test_a_student_is_told_by_the_folder_or_the_name(place, student, names, lesson):
    file = hand_in_by_place(Path("in", place), PurePosixPath(place))
    assert (file.student, [*file.names], file.lesson) == (student, names, lesson)
    assert file.is_late == ("LATE" in place)


def test_a_students_folder_is_one_student_and_zip_files_are_opened(tmp_path, monkeypatch):
    monkeypatch.setattr(zipfile.ZipFile, "read", None)  # it may unpack more than is declared
    for name in ("03_convolution_by_hand.ipynb", "mine.py", "helper.py"):
        hand_in(tmp_path / "ann" / name, FRAMES_SEEN)
    unpacked = tmp_path / "unpacked"
    unpacked.mkdir()
    assert [each.student for each in find_files(tmp_path / "ann", unpacked)] == ["ann", "ann"]
    with zipfile.ZipFile(tmp_path / "all.zip", "w") as packed:
        packed.writestr("../../leeann_7_8_07_going_deep.py", FRAMES_SEEN)
        packed.writestr("bob_7_9_work.zip", "no zip file")
        packed.writestr("__MACOSX/._x.py", "")
    bob, ann = find_files(tmp_path / "all.zip", unpacked)
    assert (ann.student, bob.student) == ("leeann 7", "bob 7")
    assert "is not a zip file" in bob.fault and ann.path.parent.parent == unpacked
    with zipfile.ZipFile(tmp_path / "small.zip", "w", zipfile.ZIP_LZMA) as packed:
        packed.writestr("ann_7_8_07.py", FRAMES_SEEN)
    (small,) = find_files(tmp_path / "small.zip", unpacked)
    assert "stored or deflated" in small.fault


def test_a_large_file_in_a_zip_costs_one_student(tmp_path, monkeypatch):
    monkeypatch.setattr(handed_in, "MOST_BYTES", 1000)
    unpacked = tmp_path / "unpacked"
    unpacked.mkdir()
    with zipfile.ZipFile(tmp_path / "all.zip", "w") as packed:
        packed.writestr("ann_7_8_07.py", "#" * 2000)
        packed.writestr("bob_7_9_07.py", FRAMES_SEEN)
    ann, bob = find_files(tmp_path / "all.zip", unpacked)
    assert (ann.student, bob.student) == ("ann 7", "bob 7")
    assert "too large" in ann.fault and not ann.path.exists()
    assert bob.fault == "" and bob.path.read_text() == FRAMES_SEEN


def test_marks_and_feedback_of_a_class(tmp_path, capsys, shared_grading):
    submitted, table, feedback = (tmp_path / name for name in ("in", "marks.csv", "feedback"))
    hand_in(submitted / "ann" / "week" / "07_going_deep.ipynb", FRAMES_SEEN)
    hand_in(submitted / "=cmd()_07.ipynb", WRONG_FRAMES_SEEN)
    hand_in(submitted / "ben_07.ipynb", WRONG_FRAMES_SEEN)
    hand_in(submitted / "ben" / "again.ipynb", FRAMES_SEEN)
    (submitted / "ann" / "week" / "mine.py").write_text("1 / 0")
    (submitted / "eve.ipynb").write_text("{")
    (submitted / "fay.ipynb").symlink_to(submitted / "ben" / "again.ipynb")
    command = ["verify", str(submitted), "--csv", str(table), "--feedback", str(feedback)]
    assert main(command) == 1
    assert "ann: 07_going_deep.ipynb: 10 of 60 points" in capsys.readouterr().out
    rows = rows_of(table)
    assert list(rows) == ["maximum", "'=cmd()", "ann", "ben", "eve", "fay"]
    points = [(row["frames_seen"], row["lesson 07"], row["total"]) for row in rows.values()]
    one, zero, none = ("10", "10", "10"), ("0", "0", "0"), ("", "", "0")
    assert points == [("10", "60", "60"), zero, one, one, none, none]
    assert rows["'=cmd()"]["problems"] == "'=cmd()_07.ipynb has no points"
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
    files = [HandedIn(report.path, student, (student,)) for student in students]
    reports = [report] * len(students)
    marks = ClassMarks(files, table=tmp_path / "marks.csv")
    write_feedback(tmp_path / "feedback", marks.by_student(reports))
    assert len(list((tmp_path / "feedback").glob("*.md"))) == len(students)
    marks.write_tables(reports)
    text = (tmp_path / "marks.csv").read_text(encoding="utf-8")
    assert len(text.splitlines()) == 2 + len(students) and "caf\\udce9" in text


@pytest.mark.parametrize("system", CLASSES["systems"])
def test_marks_go_through_the_roster_of_a_system_and_a_second_run_keeps_them(
    system, tmp_path, capsys, shared_grading
):
    export, encoding, names = CLASSES["systems"][system]
    submitted, table, roster = (tmp_path / name for name in ("in", "marks.csv", "class.csv"))
    roster.write_bytes("\n".join([*export, ""]).encode(encoding))
    ann, sid, bob = (submitted / os.fsdecode(name.encode()) for name in names)
    hand_in(ann, WRONG_FRAMES_SEEN), hand_in(sid, TANH), hand_in(bob, FRAMES_SEEN)
    late = tmp_path / "late.txt"
    late.write_text("Ann Löwe\n", encoding="utf-8")
    command = ["verify", str(submitted), "--csv", str(table), "--roster", str(roster)]
    assert main([*command, "--late", str(late)]) == 1
    printed = capsys.readouterr().out
    assert printed.index("NO ROW") < printed.index("NO FILE") < printed.index(", by ")
    of_ann, of_zoe, of_sid = read_roster(roster).students
    rows = read_roster(table).students
    assert list(rows)[:4] == ["maximum", of_ann, of_zoe, of_sid] and len(rows) == 5
    expected = f"{visible(ann.name)} has no points; lesson 05 missing; {visible(ann.name)} late"
    assert rows[of_ann]["problems"] == expected
    assert rows[of_zoe]["problems"] == "nothing handed in"
    assert "not in the roster" in [*rows.values()][4]["problems"]
    imported = read_roster(tmp_path / "marks_import.csv")
    assert (imported.encoding, imported.delimiter) == (encoding, read_roster(roster).delimiter)
    marks = [(row["Lesson 05"], row["Lesson 07"]) for row in imported.students.values()]
    assert marks == [("0", "0"), ("", ""), ("10", "0")]  # who has no row may be the second
    possible = [row["Lesson 05"] for row in imported.other_rows if "Possible" in row["Student"]]
    assert possible == ["90"] * (system == "canvas")
    failed = rows_of(tmp_path / "marks_statistics.csv")["frames_seen"]
    assert (failed["property"], failed["handed in"], failed["failed"]) == ("value", "2", "1")

    hand_in(ann, FRAMES_SEEN), sid.unlink()
    table.write_text(
        table.read_text("utf-8").replace(f"{of_sid},10,", f"{of_sid},excused,"), "utf-8"
    )
    assert main(command) < 2
    again = read_roster(table).students
    assert again[of_ann]["frames_seen"] == "10" and "excused" in again[of_sid].values()
    assert read_roster(tmp_path / "marks.1.csv").students[of_sid]["tanh"] == "excused"


def test_an_import_that_would_be_wrong_is_refused_and_says_why(tmp_path, capsys, shared_grading):
    submitted, roster = tmp_path / "in", tmp_path / "class.csv"
    hand_in(submitted / "ann.ipynb", FRAMES_SEEN), hand_in(submitted / "bob.ipynb", FRAMES_SEEN)
    command = ["verify", str(submitted), "--csv", str(tmp_path / "m.csv"), "--feedback"]
    command += [str(tmp_path / "feedback"), "--roster", str(roster)]
    for listed, said in CLASSES["refused"]:
        roster.write_text(listed.replace("LONG", 200_000 * "x"))
        assert main(command) == 2 and said in capsys.readouterr().err
    assert (tmp_path / "feedback" / "ann.md").exists()
    assert not (tmp_path / "m_import.csv").exists()
    assert main(["verify", str(submitted), "--roster", str(roster)]) == 2


def test_nbgrader_gets_the_points_of_the_command_in_the_check_cells(tmp_path, monkeypatch):
    # An optional module of jsonschema, which nbformat imports, takes seconds to compile a grammar.
    monkeypatch.setitem(sys.modules, "rfc3987_syntax", None)
    nbformat = pytest.importorskip("nbformat")
    from numpy_cae.course.nbgrader import grade_notebook

    (cell,) = read_notebook(hand_in(tmp_path / "07_going_deep.ipynb", FRAMES_SEEN))["cells"]
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
