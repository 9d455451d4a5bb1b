"""The machinery of the lessons: exercises, stand-ins, students' copies, the command."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from numpy_cae import course, ops, viz
from numpy_cae.cli import main
from numpy_cae.course import read_notebook, source_hash, student_copy, write_notebook
from numpy_cae.course.exercises import EXERCISES, LESSONS
from numpy_cae.course.exercises.exercise import Claim, exercise, require_same, unaltered
from numpy_cae.motion import PARENTS
from numpy_cae.verify.grading import grade
from numpy_cae.verify.trial import try_property

COURSE = "numpy_cae.course.catalogue"


def unsolved(*arguments):
    raise NotImplementedError


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


@pytest.mark.parametrize("name", EXERCISES)
def test_the_package_solves_its_own_exercises_and_a_stub_solves_none(name):
    report = course.report(name, EXERCISES[name].solution)
    assert report.held and report.possible == EXERCISES[name].points, str(report)
    stub = course.report(name, unsolved)
    assert stub.unsolved and stub.points == 0
    assert "not solved yet" in str(stub) and f"hint: {EXERCISES[name].hint[:20]}" in str(stub)


@pytest.mark.parametrize("name", EXERCISES)
def test_returning_the_first_argument_or_nothing_fails_every_exercise(name):
    for cheat in (lambda *arguments: arguments[0], lambda *arguments: None):
        report = course.report(name, cheat)
        assert not report.held and not report.unsolved
        assert report.points < report.possible / 2, str(report)


def test_no_name_stands_twice():
    assert len(EXERCISES) == sum(map(len, LESSONS.values()))


def test_a_wrong_solution_is_told_the_counterexample_and_a_hint():
    def speeds(positions, rate):
        return np.linalg.norm(np.diff(positions, axis=0), axis=-1) / rate

    text = str(course.report("speeds", speeds))
    assert "FAILED  value" in text and "smallest: frames 2, joints 1" in text
    assert "hint: the distance to the next frame" in text


def test_later_cells_go_on_with_the_students_own_or_the_packages(capsys):
    assert course.solved("conv1d", ops.tanh) is not ops.tanh
    assert "the package's own" in capsys.readouterr().out
    stand_in = course.solved("conv1d", unsolved)
    capsys.readouterr()
    x, w, b = np.ones((1, 4, 2)), np.ones((3, 2, 1)), np.zeros(1)
    np.testing.assert_array_equal(stand_in(x, w, b)[0], ops.conv1d(x, w, b)[0])

    def mine(x, w, b):
        return ops.conv1d(x, w, b)

    assert course.solved("conv1d", mine) is mine
    assert capsys.readouterr().out == "conv1d: from here on, yours\n"


def test_a_stand_in_is_never_taken_for_the_students(capsys):
    stand_in = course.solved("conv1d", unsolved)
    report = course.report("conv1d", stand_in)
    assert report.unsolved and report.points == 0
    assert "run the cell with yours again first" in capsys.readouterr().out


def test_no_such_exercise_is_an_error_with_the_names():
    with pytest.raises(ValueError, match="no exercise is called 'conv'; there are chain_to_root"):
        course.solved("conv", ops.tanh)


def test_to_nbgrader_a_check_that_fails_raises(monkeypatch):
    monkeypatch.setenv("NBGRADER_EXECUTION", "autograde")
    with pytest.raises(AssertionError, match="0 of 16 points"):
        course.report("conv1d", unsolved)
    assert course.report("conv1d", ops.conv1d).held


def test_a_claim_of_purity_catches_an_altered_argument():
    def arguments(case):
        return {"x": np.ones(case["frames"])}

    claims = (unaltered(arguments),)
    of_doubling = exercise("double", "", lambda x: 2 * x, arguments, {"frames": (1, 2)}, claims)

    def in_place(x):
        x *= 2
        return x

    (purity,) = of_doubling.properties
    outcome = try_property(purity, in_place)
    assert not outcome.held and outcome.problem == "the call alters x"
    assert try_property(purity, lambda x: 2 * x).held


@pytest.mark.parametrize(
    ("found", "expected", "said"),
    [
        (None, np.ones(2), "is None: is a return missing"),
        ("two", np.ones(2), "is str, expected numbers"),
        (np.ones(3), np.ones(2), r"shape \(3,\), expected \(2,\)"),
        (np.ones(2), (1.0, 2.0), "it returns ndarray, expected a, b"),
        ((1.0, 3.0), (1.0, 2.0), "b is 3, expected 2"),
    ],
)
def test_what_differs_is_said(found, expected, said):
    with pytest.raises(AssertionError, match=said):
        require_same(found, expected, ("a", "b"))


def test_a_counterexample_too_long_to_print_can_be_had():
    def locally(parents, rotations, translations):
        positions = translations.copy()
        for joint, parent in enumerate(parents):
            if parent != -1:
                reach = rotations[:, parent] @ translations[:, joint, :, None]
                positions[:, joint] = positions[:, parent] + reach[..., 0]
        return positions

    text = str(course.report("forward_kinematics", locally))
    assert 'example("forward_kinematics", frames=1, joints=3, seed=0)' in text
    example = course.example("forward_kinematics", frames=1, joints=3, seed=0)
    assert list(example) == ["parents", "rotations", "translations"]
    right = EXERCISES["forward_kinematics"].solution(**example)
    assert np.abs(locally(**example) - right).max() > 0.1
    with pytest.raises(ValueError, match="forward_kinematics has the sizes frames, joints, got fr"):
        course.example("forward_kinematics", frames=1, seed=0)


def test_hints_of_a_claim_stand_where_it_fails():
    def fails(function, case):
        raise AssertionError("no")

    claim = Claim("value", "is right", fails, hint="think")
    of_one = exercise("one", "hint", lambda: 1, lambda case: {}, {"n": (1,)}, (claim,))
    assert try_property(of_one.properties[0], lambda: 1).property.hint == "think"


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
        (a_lesson("return 2\n    ### END SOLUTION"), "stands where it does not belong"),
        (a_lesson(marked=False), "in a cell that is no exercise"),
    ],
)
def test_a_damaged_lesson_is_an_error(lesson, said):
    with pytest.raises(ValueError, match=said):
        student_copy(lesson)


def test_notebooks_are_written_as_read(tmp_path):
    path = tmp_path / "01_double.ipynb"
    write_notebook(a_lesson(), path)
    assert read_notebook(path) == a_lesson()
    assert json.loads(path.read_text())["cells"][0]["source"] == ["# Title\n", "\n", "Text"]


def test_the_hash_is_of_the_code():
    changed = a_lesson()
    changed["cells"][1]["source"] += "\n"
    assert source_hash(changed) != source_hash(a_lesson())
    changed = a_lesson()
    changed["cells"][1]["outputs"] = []
    assert source_hash(changed) == source_hash(a_lesson())


def test_the_command_writes_copies_and_overwrites_nobodys_work(tmp_path, capsys):
    write_notebook(a_lesson(), tmp_path / "01_double.ipynb")
    student = tmp_path / "student"
    command = ["lessons", str(student), "--from", str(tmp_path)]
    assert main(command) == 0
    copy = read_notebook(student / "01_double.ipynb")
    assert copy == student_copy(a_lesson())
    assert main(command) == 2
    assert "has 01_double.ipynb already" in capsys.readouterr().err
    assert main(["lessons", str(tmp_path), "--from", str(tmp_path)]) == 2
    assert "name another folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "expected either a folder for the student's copies or --execute"),
        (["student", "--execute"], "expected either a folder"),
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


def test_a_file_that_is_no_notebook_is_said(tmp_path, capsys):
    (tmp_path / "01_double.ipynb").write_text("not json")
    assert main(["lessons", str(tmp_path / "student"), "--from", str(tmp_path)]) == 2
    assert "01_double.ipynb: not a Jupyter notebook" in capsys.readouterr().err


def test_without_nbclient_executing_says_what_is_missing(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "nbclient", None)
    write_notebook(a_lesson(), tmp_path / "01_double.ipynb")
    assert main(["lessons", "--execute", "--from", str(tmp_path)]) == 2
    assert "pip install '.[lessons]'" in capsys.readouterr().err


def test_a_notebook_is_graded_by_its_exercise_cells(tmp_path):
    right = EXERCISES["speeds"]
    source = (
        "def speeds(positions, rate):\n"
        "    return rate * np.sqrt((np.diff(positions, axis=0) ** 2).sum(axis=-1))"
    )
    lesson = a_lesson()
    lesson["cells"][1] |= {"source": source}
    lesson["cells"].append({"cell_type": "code", "metadata": {}, "source": "import numpy_cae; 1/0"})
    path = tmp_path / "01_somebody.ipynb"
    path.write_text(json.dumps(lesson))
    report = grade(path, COURSE)
    assert report.held and report.points == right.points, str(report)
    path.write_text(json.dumps(lesson).replace("rate * np", "np"))
    assert 0 < len(grade(path, COURSE).reports) and not grade(path, COURSE).held


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[]", "not a Jupyter notebook"),
        ("{", "not a Jupyter notebook"),
        ('{"cells": []}', "no exercise cell"),
    ],
)
def test_a_file_that_is_no_lesson_fails_and_not_the_grader(text, said, tmp_path):
    path = tmp_path / "somebody.ipynb"
    path.write_text(text)
    assert said in grade(path, COURSE).faults[0]


def test_an_animation_shows_itself_and_is_small():
    body = np.random.default_rng(0).normal(size=(30, 20, 3))
    shown = viz.in_notebook([viz.Actor(body, PARENTS, "noise")], rate=30.0)
    html = shown._repr_html_()
    assert html.startswith('<img alt="noise" src="data:image/gif;base64,R0lGODlh')
    assert len(html) < 250_000 and repr(shown) == "an animation: noise"


def test_the_instructors_table_has_every_exercise_with_its_points():
    text = Path(__file__).parents[2].joinpath("lessons", "README.md").read_text(encoding="utf-8")
    for number, exercises in LESSONS.items():
        for each in exercises:
            assert f"| {number} | `{each.name}` | {each.points} | " in text
