"""Marks of a class: who handed in what, the table and the feedback."""

import csv
import json
from pathlib import Path

import pytest

from numpy_cae.cli import main
from numpy_cae.course.marks import lesson_of, student_id

LOOPS = "def frames_seen(taps, layers):\n    n = 1\n    for _ in range(layers):\n"
LOOPS += "        n = 2 * n + taps - 1\n    return n\n"
WRONG = "def frames_seen(taps, layers):\n    return taps\n"


def hand_in(path: Path, source: str) -> None:
    marks = {"nbgrader": {"solution": True, "grade_id": "frames_seen"}}
    cell = {"cell_type": "code", "metadata": marks, "source": source}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps({"cells": [cell]}), encoding="utf-8")


@pytest.mark.parametrize(
    ("file", "student", "lesson"),
    [
        ("ann/week3/03_convolution_by_hand.ipynb", "ann", ""),
        ("ann/07.ipynb", "ann", "07"),
        ("ann_03.ipynb", "ann", "03"),
        ("ann_b_03.py", "ann_b", "03"),
        ("03_ann.py", "ann", ""),
        ("ann.ipynb", "ann", ""),
        ("ann_99.ipynb", "ann_99", ""),
        ("03_12.ipynb", "12", ""),
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
    command = ["verify", str(submitted), "--csv", str(table), "--feedback", str(feedback)]
    assert main(command) == 1
    assert "ann: 07_going_deep.ipynb: 10 of 60 points" in capsys.readouterr().out
    with table.open(newline="", encoding="utf-8") as file:
        rows = {row["student"]: row for row in csv.DictReader(file)}
    assert list(rows) == ["'=cmd()", "ann", "ben", "eve"]
    points = {student: (row["frames_seen"], row["total"]) for student, row in rows.items()}
    assert points == {
        "'=cmd()": ("0", "0"),
        "ann": ("10", "10"),
        "ben": ("10", "10"),
        "eve": ("", "0"),
    }
    assert {row["possible"] for row in rows.values()} == {"60"} and "stack_loss" in rows["ann"]
    assert "not a Jupyter notebook" in rows["eve"]["problems"]
    assert sorted(path.name for path in feedback.iterdir()) == [
        "_cmd___1.md",
        "ann.md",
        "ben.md",
        "eve.md",
    ]
    text = (feedback / "_cmd___1.md").read_text(encoding="utf-8")
    assert "## frames_seen: 0 of 10 points" in text and "      FAILED  value" in text


def test_nbgrader_gets_the_points_of_the_command_in_the_check_cells(tmp_path):
    nbformat = pytest.importorskip("nbformat")
    from numpy_cae.course.nbgrader import grade_notebook

    hand_in(tmp_path / "07_going_deep.ipynb", LOOPS)
    (cell,) = json.loads((tmp_path / "07_going_deep.ipynb").read_text())["cells"]
    marks = {"nbgrader": {"grade": True, "grade_id": "stack_loss_check", "points": 40}}
    check = {"cell_type": "code", "metadata": marks, "source": "1 / 0"}
    cells = [{**each, "execution_count": None, "outputs": []} for each in (cell, check)]
    node = nbformat.from_dict({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5})
    graded, _ = grade_notebook(node, {"nbgrader": {"notebook": "07_going_deep"}})
    shown = {}
    for each in graded.cells[1:]:
        text, points = each.outputs
        assert f"{points.data['text/plain']} of " in text.text
        shown[each.metadata["nbgrader"]["grade_id"]] = points.data["text/plain"]
    assert shown.pop("frames_seen_check") == "10"  # whose check cell was deleted
    assert set(shown.values()) == {"0"} and {"stack_loss_check", "stage_inputs_check"} <= set(shown)
