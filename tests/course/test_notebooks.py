"""Notebooks: students' copies, releases for nbgrader, the command `numpy-cae lessons`."""

import json
import zipfile
from pathlib import Path

import pytest
from submissions import CLASSES

from numpy_cae.cli import main
from numpy_cae.course.copies import write_notebook
from numpy_cae.course.notebooks import find_lessons, read_notebook, student_copy

LESSONS = find_lessons(Path(__file__).parents[2] / "lessons")
HEAD = 'def double(x):\n    """Twice x."""\n    '


def a_lesson(solution: str = "", marked: bool = True) -> dict:
    """A lesson with one exercise, with another solution or without the exercise's marks."""
    lesson = json.loads(Path(__file__).with_name("double.json").read_text("utf-8"))
    exercise = lesson["cells"][1]
    exercise["source"] = HEAD + solution if solution else exercise["source"]
    exercise["metadata"] = exercise["metadata"] if marked else {}
    return lesson


@pytest.mark.parametrize(
    "lesson", [a_lesson("### BEGIN SOLUTION\n    return 2"), a_lesson(marked=False)]
)
def test_a_damaged_lesson_is_an_error(lesson):
    with pytest.raises(ValueError, match=r"without ### END|in a cell that is no exercise"):
        student_copy(lesson)


def test_the_command_writes_copies_and_overwrites_nobodys_work(tmp_path, capsys):
    path, student = tmp_path / "01_double.ipynb", tmp_path / "student"
    command = ["lessons", str(student), "--from", str(tmp_path)]
    path.write_text("not json")
    assert main(command) == 2
    assert "01_double.ipynb: not a Jupyter notebook" in capsys.readouterr().err
    write_notebook(a_lesson(), path)
    assert read_notebook(path) == a_lesson()
    assert main(command) == 0
    copy = read_notebook(student / "01_double.ipynb")
    assert copy["metadata"] == {} and copy["cells"][0] == a_lesson()["cells"][0]
    stub = {"source": HEAD + "# YOUR CODE HERE\n    raise NotImplementedError()", "outputs": []}
    assert copy["cells"][1] == a_lesson()["cells"][1] | stub | {"execution_count": None}
    (student / "01_double.ipynb").write_text("a student's work")
    (student / "mine.py").unlink()
    assert main([*command, "--only", "01"]) == 0
    assert "01_double.ipynb exists and is kept" in capsys.readouterr().out
    assert (student / "01_double.ipynb").read_text() == "a student's work"
    assert "import numpy as np" in (student / "mine.py").read_text()


@pytest.mark.parametrize(("words", "said"), CLASSES["commands"])
def test_what_the_command_cannot_do_is_said_in_a_line(words, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_notebook(a_lesson(), tmp_path / "01_double.ipynb")
    assert main(["lessons", *(word.format(here=tmp_path) for word in words)]) == 2
    error = capsys.readouterr().err
    assert said in error and len(error.splitlines()) == 1


def test_the_command_writes_the_students_copies_of_all_lessons(tmp_path):
    assert main(["lessons", str(tmp_path)]) == 0
    assert [path.name for path in find_lessons(tmp_path)] == [path.name for path in LESSONS]
    for path in LESSONS[0].parent.glob("*.ipynb"):
        assert read_notebook(tmp_path / path.name) == student_copy(read_notebook(path))


@pytest.mark.parametrize(("number", "milestones"), [("03", []), ("08", ["milestone_08.ipynb"])])
def test_one_lesson_comes_with_the_milestone_that_follows_it(number, milestones, tmp_path):
    assert main(["lessons", str(tmp_path), "--only", number]) == 0
    (lesson,) = [path.name for path in LESSONS if path.name.startswith(number)]
    written = [path.name for path in tmp_path.iterdir()]
    assert sorted(written) == [lesson, *milestones, "mine.py"]


def test_a_release_is_laid_out_for_nbgrader_and_holds_no_solution(tmp_path):
    packed, third = tmp_path / "week3.zip", LESSONS[3].name
    assert main(["lessons", "--release", str(packed), "03", "04"]) == 0
    with zipfile.ZipFile(packed) as file:
        file.extractall(tmp_path)
        assert len(file.namelist()) == 7
    assert (tmp_path / "nbgrader_config.py").is_file()
    release, source = tmp_path / "release" / "week3", tmp_path / "source" / "week3"
    assert (release / "mine.py").is_file() and (source / "mine.py").is_file()
    released, of_source = read_notebook(release / third), read_notebook(source / third)
    assert released == student_copy(read_notebook(LESSONS[3]))
    assert "BEGIN SOLUTION" in json.dumps(of_source) and "np.pad" not in json.dumps(of_source)
    assert student_copy(of_source) == released  # as nbgrader makes it
