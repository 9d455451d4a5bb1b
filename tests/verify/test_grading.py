"""Files that disturb the grading as they can: each ends in a report that says what it did."""

import subprocess
import sys

import pytest
from acclaim_files import FILES

from numpy_cae.cli import main

RIGHT = "import numpy as np\ndef tanh(x):\n    y = np.tanh(x)\n"
RIGHT += "    return y, lambda dy: dy * (1 - y * y)\n"
SEVERAL = (FILES / "several_mistakes.py").read_text()

ENDLESS = (FILES / "endless_functions.py").read_text()


@pytest.fixture
def most_cases():
    """All: reports name the smallest case that fails, and the last one that holds."""
    return None


def test_each_function_of_a_file_has_its_report(graded):
    file = graded(SEVERAL)
    of = {report.operation: report for report in file.reports}
    assert not file.held and not file.faults and 0 < file.points < file.possible
    assert "1 - x², where it should be 1 - y²" in str(of["tanh"])
    assert "smallest: batch 1, frames 1, channels 1" in str(of["tanh"])
    assert of["sigmoid"].held and of["sigmoid"].points == of["sigmoid"].possible == 11
    assert not of["mean_squared_error"].held
    told = " ".join(str(of["mean_squared_error"]).split())
    assert "another convention, which may be allowed: half the mean" in told
    escaped = str(of["linear"])
    assert "\\x1b[2J" in escaped and "\x1b" not in escaped and len(escaped) < 5000


def test_a_helper_that_shares_its_name_with_an_operation_is_not_tested(graded):
    helpers = """
def gru_step(x, h):
    return h.data

def helped(x):
    return gru_step(x, sigmoid(x))
"""
    file = graded("from numpy import exp as sigmoid\n" + RIGHT + helpers)
    assert file.held and [report.operation for report in file.reports] == ["tanh"]
    assert [note.partition(" is called")[0] for note in file.notes] == ["sigmoid", "gru_step"]
    assert not graded(helpers).held


def test_without_the_functions_to_be_tested_the_file_fails(graded):
    file = graded(RIGHT, lesson="05")
    assert file.reports[0].points == 10
    assert file.possible == 90 and "it has no function arctanh" in str(file)
    assert "no function has an operation's name" in graded("x = 1").faults[0]


def test_a_warning_costs_no_points(graded):
    warning = "    import warnings; warnings.warn('careful'); np.log(np.float64(0))\n    y = "
    overflows = "def sigmoid(x):\n    y = 1 / (1 + np.exp(-x))\n"
    overflows += "    return y, lambda dy: dy * y * (1 - y)\n"
    assert graded(f"import warnings; warnings.simplefilter('error')\n{RIGHT}{overflows}").held
    assert graded(RIGHT.replace("    y = ", warning)).held


def test_endless_loops_end(graded):
    report = graded(RIGHT + ENDLESS, cpu_seconds=2.0)
    by_name = {r.operation: r for r in report.reports}
    assert by_name["tanh"].held and not by_name["max_pool"].held and not by_name["linear"].held
    assert "endless loop" in by_name["max_pool"].outcomes[0].problem
    assert "its process ended" in by_name["linear"].outcomes[0].problem
    assert "KeyboardInterrupt" in by_name["sigmoid"].outcomes[0].problem
    assert report.points == 10 and not report.faults


def test_the_command_grades_folders_and_goes_on_where_a_file_is_missing(
    tmp_path, capsys, shared_grading
):
    assert main(["verify", str(tmp_path), str(tmp_path / "nowhere.py")]) == 2
    assert "nowhere.py: there is no such file" in capsys.readouterr().err
    (tmp_path / "marks.json").write_text("{}")
    assert main(["verify", str(tmp_path / "marks.json")]) == 2
    assert "marks.json: no Python file and no notebook" in capsys.readouterr().err
    right = tmp_path / "group" / "right.py"
    right.parent.mkdir()
    right.write_text(RIGHT)
    assert main(["verify", str(tmp_path / "nowhere.py"), str(tmp_path)]) == 1
    printed = capsys.readouterr().out
    assert "there is no such file" in printed and "right.py: 10 of 10 points, every" in printed
    assert main(["verify", str(right)]) == 0
    right.write_text("import torch")
    assert main(["verify", str(right)]) == 1
    assert "no points, FAILED" in capsys.readouterr().out


def test_a_right_function_that_is_too_slow_for_the_largest_size_keeps_what_it_earned(graded):
    slow = RIGHT.replace("    y = ", "    while x.size > 9999: pass\n    y = ")
    (report,) = graded(slow, cpu_seconds=2.0).reports
    held = {outcome.property_.name for outcome in report.outcomes if outcome.held}
    assert {"value", "gradient for x", "purity"} <= held and not report.held
    assert report.points >= 8 and "smaller cases were right" in str(report)


def test_one_file_is_graded_without_the_marks_of_a_class(tmp_path):
    (tmp_path / "right.py").write_text(RIGHT)
    code = "import sys; from numpy_cae.cli import main; status = main(['verify', 'right.py']); "
    code += "sys.exit(status or 'numpy_cae.course.marks' in sys.modules)"
    command = [sys.executable, "-c", code]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True).returncode == 0


def test_the_lesson_of_a_file_may_stand_at_the_end_of_its_name(graded):
    assert graded(RIGHT, name="ann_05-Copy1.py").possible == 90
