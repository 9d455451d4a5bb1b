"""The scripts for Gradescope and GitHub, run as these systems run them."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from submissions import FRAMES_SEEN, LESSON_FILES, hand_in

AUTOGRADING = LESSON_FILES / "autograding"


@pytest.fixture(scope="module")
def gradescope(tmp_path_factory):
    """The folder /autograder after a submission of lesson 07 was graded."""
    folder = tmp_path_factory.mktemp("autograder")
    hand_in(folder / "submission" / "07_going_deep.ipynb", FRAMES_SEEN)
    script = AUTOGRADING / "gradescope" / "grade.py"
    subprocess.run([sys.executable, str(script), "07"], cwd=folder, check=True)
    return folder


@pytest.fixture(scope="module")
def results(gradescope):
    return json.loads((gradescope / "results" / "results.json").read_text("utf-8"))


def test_gradescope_gets_a_test_for_each_exercise(results):
    scores = {test["name"]: (test["score"], test["max_score"]) for test in results["tests"]}
    assert scores == {"frames_seen": (10, 10), "stage_inputs": (0, 10), "stack_loss": (0, 40)}


def test_gradescope_gets_the_score_and_the_reports(results):
    assert results["score"] == 10
    assert "it has no function stack_loss" in results["tests"][2]["output"]


def test_gradescope_gets_a_sentence_where_nothing_can_be_graded(tmp_path):
    (tmp_path / "submission").mkdir()
    (tmp_path / "submission" / "07.pdf").write_text("x")
    script = AUTOGRADING / "gradescope" / "grade.py"
    subprocess.run([sys.executable, str(script), "07"], cwd=tmp_path, check=True)
    results = json.loads((tmp_path / "results" / "results.json").read_text("utf-8"))
    assert results["score"] == 0 and "a .pdf cannot be graded" in results["output"]


def test_the_script_for_gradescope_names_the_files_of_its_folder():
    text = (AUTOGRADING / "gradescope" / "run_autograder").read_text()
    assert text.startswith("#!/usr/bin/env bash\n") and "/autograder/source/grade.py" in text
    assert os.access(AUTOGRADING / "gradescope" / "run_autograder", os.X_OK)


@pytest.fixture
def report_points(tmp_path):
    """Run the script with results; its output and the summary of the job."""

    def report_points(points):
        result = {"student": "ann", "file": "a.ipynb", "exercise": "conv1d", "text": "conv1d: so"}
        result |= {"points": points, "possible": 40}
        path = tmp_path / "results.json"
        path.write_text(json.dumps({"results": [result, result | {"points": 0}]}))
        summary = tmp_path / "summary.md"
        ended = subprocess.run(
            [sys.executable, str(AUTOGRADING / "github" / "report_points.py"), str(path)],
            env=os.environ | {"GITHUB_STEP_SUMMARY": str(summary)},
            capture_output=True,
            text=True,
        )
        return ended, summary.read_text("utf-8")

    return report_points


def test_github_gets_the_points_as_classrooms_reporter_writes_them(report_points):
    ended, _ = report_points(8)
    complete, report = ended.stdout.splitlines()
    assert complete == "::notice title=Autograding complete::Points 8/40"
    assert report == '::notice title=Autograding report::{"totalPoints":8,"maxPoints":40}'


def test_github_shows_the_reports_and_a_cross(report_points):
    ended, summary = report_points(8)
    assert ended.returncode == 1 and "### conv1d: 8 of 40 points\n\n    conv1d: so" in summary


def test_github_shows_a_tick_where_all_points_are_reached(report_points):
    ended, _ = report_points(40)
    assert ended.returncode == 0


def test_the_workflow_has_the_names_that_classroom_asks_for():
    yaml = pytest.importorskip("yaml")
    text = (AUTOGRADING / "github" / "autograding.yml").read_text()
    workflow = yaml.safe_load(text)
    assert (workflow["name"], list(workflow["jobs"])) == (
        "Autograding Tests",
        ["run-autograding-tests"],
    )


def test_the_workflow_grades_and_reports():
    yaml = pytest.importorskip("yaml")
    workflow = yaml.safe_load((AUTOGRADING / "github" / "autograding.yml").read_text())
    steps = {step.get("name"): step for step in workflow["jobs"]["run-autograding-tests"]["steps"]}
    assert "verify 03_*.ipynb --lesson 03 --json results.json" in steps["Grade"]["run"]
    assert (AUTOGRADING / "github" / Path(steps["Report"]["run"].split()[1]).name).is_file()
