"""Notebooks: students' copies, the hash of the source, the command `numpy-cae lessons`."""

import json
import sys
import zipfile
from pathlib import Path

import pytest

from numpy_cae.cli import main
from numpy_cae.course.copies import student_copy
from numpy_cae.course.notebook import find_lessons, read_notebook, write_notebook

LESSONS = find_lessons(Path(__file__).parents[2] / "lessons")


def a_lesson(solution="### BEGIN SOLUTION\n    return 2 * x\n    ### END SOLUTION", marked=True):
    marks = {"nbgrader": {"solution": True, "grade_id": "double"}} if marked else {}
    cell = {
        "cell_type": "code",
        "id": "double",
        "metadata": marks,
        "source": f'def double(x):\n    """Twice x."""\n    {solution}',
        "outputs": [{"output_type": "stream", "name": "stdout", "text": "hello"}],
        "execution_count": 3,
    }
    title = {"cell_type": "markdown", "id": "title", "metadata": {}, "source": "# Title\n\nText"}
    metadata = {"numpy_cae": {"source_hash": "x"}}
    return {"cells": [title, cell], "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}


def test_the_student_copy_has_a_stub_and_no_outputs():
    lesson = a_lesson()
    copy = student_copy(lesson)
    (cell,) = [c for c in copy["cells"] if c["cell_type"] == "code"]
    assert cell["source"] == (
        'def double(x):\n    """Twice x."""\n    # YOUR CODE HERE\n    raise NotImplementedError()'
    )
    assert cell["outputs"] == [] and cell["execution_count"] is None
    assert lesson == a_lesson() and copy["metadata"] == {}


@pytest.mark.parametrize(
    ("lesson", "said"),
    [
        (a_lesson("### BEGIN SOLUTION\n    return 2"), "without ### END"),
        (a_lesson("return 2\n    ### END SOLUTION"), "or the other way round"),
        (a_lesson("### BEGIN SOLUTION\n    ### BEGIN SOLUTION\n    ### END SOLUTION"), "without"),
        (a_lesson(marked=False), "in a cell that is no exercise"),
    ],
)
def test_a_damaged_lesson_is_an_error(lesson, said):
    with pytest.raises(ValueError, match=said):
        student_copy(lesson)


def test_the_command_writes_copies_and_overwrites_nobodys_work(tmp_path, capsys):
    path, student = tmp_path / "01_double.ipynb", tmp_path / "student"
    command = ["lessons", str(student), "--from", str(tmp_path)]
    path.write_text("not json")
    assert main(command) == 2
    assert "01_double.ipynb: not a Jupyter notebook" in capsys.readouterr().err
    write_notebook(a_lesson(), path)
    assert read_notebook(path) == a_lesson()
    assert json.loads(path.read_text())["cells"][0]["source"] == ["# Title\n", "\n", "Text"]
    assert main(command) == 0
    copy = read_notebook(student / "01_double.ipynb")
    assert copy == student_copy(a_lesson())
    (student / "01_double.ipynb").write_text("a student's work")
    (student / "mine.py").unlink()
    capsys.readouterr()
    assert main([*command, "--only", "01"]) == 0
    assert "01_double.ipynb exists and is kept" in capsys.readouterr().out
    assert (student / "01_double.ipynb").read_text() == "a student's work"
    assert "import numpy as np" in (student / "mine.py").read_text()
    assert main(["lessons", str(tmp_path), "--from", str(tmp_path)]) == 2
    assert "name another folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "give a folder for students, --release"),
        (["student", "--execute"], "give a folder for students"),
        (["--release", "week.zip", "03", "77"], "no lesson 77 in"),
        (["student", "--from", "nowhere"], "no lessons in nowhere"),
        (["student", "--from", "{here}", "--only", "02"], "no lesson 02 in"),
    ],
)
def test_what_the_command_cannot_do_is_said_in_a_line(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_notebook(a_lesson(), tmp_path / "01_double.ipynb")
    assert main(["lessons", *(word.format(here=tmp_path) for word in words)]) == 2
    error = capsys.readouterr().err
    assert said in error and len(error.splitlines()) == 1


def test_the_package_has_the_students_copies_of_all_lessons(tmp_path):
    assert main(["lessons", str(tmp_path)]) == 0
    assert [path.name for path in find_lessons(tmp_path)] == [path.name for path in LESSONS]
    for path in LESSONS:
        again = f"numpy-cae lessons --store --only {path.name[:2]} writes the package's copy"
        assert read_notebook(tmp_path / path.name) == student_copy(read_notebook(path)), again
        assert "BEGIN SOLUTION" not in (tmp_path / path.name).read_text(encoding="utf-8")


def test_a_release_is_laid_out_for_nbgrader_and_holds_no_solution(tmp_path):
    packed = tmp_path / "week3.zip"
    assert main(["lessons", "--release", str(packed), "03", "04"]) == 0
    with zipfile.ZipFile(packed) as file:
        texts = {name: file.read(name).decode() for name in file.namelist()}
    third = LESSONS[3].name
    assert {f"{f}/week3/{n}" for f in ("source", "release") for n in ("mine.py", third)} < set(
        texts
    )
    assert "nbgrader_config.py" in texts and len(texts) == 7
    released = json.loads(texts[f"release/week3/{third}"])
    for cell in released["cells"]:
        cell["source"] = "".join(cell["source"])
    assert released == student_copy(read_notebook(LESSONS[3]))
    source = json.loads(texts[f"source/week3/{third}"])
    for cell in source["cells"]:
        cell["source"] = "".join(cell["source"])
    assert "BEGIN SOLUTION" in str(source) and "np.pad" not in str(source)
    assert student_copy(source) == released  # as nbgrader makes it


def test_without_nbclient_executing_says_what_is_missing(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "nbformat", None)
    write_notebook(a_lesson(), tmp_path / "01_double.ipynb")
    assert main(["lessons", "--execute", "--from", str(tmp_path)]) == 2
    assert "pip install '.[lessons]'" in capsys.readouterr().err
