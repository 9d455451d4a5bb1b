"""Files that are broken or disturb their grading: none reaches the tests, and each is told so."""

import inspect
import json
import os
import re
from pathlib import Path

import pytest

from numpy_cae.confined.confinement import has_filter
from numpy_cae.course.catalogue import read_submission
from numpy_cae.course.solutions.building_blocks import unfold
from numpy_cae.verify.grading import student_file as grading

TEXT = (Path(__file__).parents[1] / "files" / "hostile_pieces.txt").read_text("utf-8")
PIECES = dict(re.findall(r"^== (\w+)\n(.*?)(?=^== |\Z)", TEXT, re.DOTALL | re.MULTILINE))
TANH = """
def tanh(x):
    y = np.tanh(x)
    {0}
    return y, lambda dy: dy * (1 - y * y)
"""
RIGHT = PIECES["IMPORTS"] + TANH.format("")
WRONG = RIGHT.replace("1 - y * y", "1 - x * x")
TO_ALL = "[os.write(i, {!r}) for i in range(3, 60) if os.path.exists(f'/proc/self/fd/{{i}}')]"
EVIL = "type('Evil', (Exception,), {'__str__': lambda self: 1 / 0})()"
FORKS = "assert ctypes.CDLL(None).fork() == -1"


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        ("def broken(:", "SyntaxError: invalid syntax"),
        (b"x = 1\0", "null bytes"),
        (b"#" * 2**21, "larger than 1 MB"),
        ("raise SystemExit", "it calls sys.exit"),
        (f"raise {EVIL}", "Evil, whose message cannot be printed"),
        ("atexit.register(os._exit, 0); 1 / 0", "ZeroDivisionError: division by zero (line 4)"),
        ("ctypes.string_at(0)", "its process ended"),
        ("x = np.ones(10**12)", "Unable to allocate"),
        ("m = __import__('to' + 'rch')", "torch may not be imported"),
        ("os.kill(os.getppid(), 9)", "PermissionError: [Errno 1] Operation not permitted"),
        ("os.rename(__file__, '/x')", "PermissionError: [Errno 13] Permission denied"),
        ("open('/x', 'w')", "PermissionError: [Errno 13] Permission denied: '/x'"),
        ("time.sleep(60)", "did not finish"),
        ("while True: pass", "an endless loop?"),
        (PIECES["FILLS"], "it wrote more than 64 MB of files"),
        ("print('\\x1b[2J'); raise ValueError('\\x1b[2J' + chr(0x202e))", "\\x1b[2J\\u202e"),
    ],
    ids=range(16),
)
def test_a_file_that_cannot_be_imported_is_a_fault(graded, content, fault):
    never_ends = content in ("time.sleep(60)", "while True: pass")
    if isinstance(content, str):
        content = PIECES["IMPORTS"] + content + TANH.format("")
    file = graded(content, cpu_seconds=1.0 if never_ends else 5.0)
    assert len(file.faults) == 1 and fault in file.faults[0]
    assert not file.held and file.points == 0
    assert file.possible == 10 or not isinstance(content, str)
    assert "\x1b" not in str(file)


WRITES = "print('x' * 10**5, chr(0xd800), file=sys.stderr); os.write(1, b'x' * 10**5)"


@pytest.mark.parametrize(
    "content",
    [
        b"\xef\xbb\xbf# coding: utf-8\n" + RIGHT.replace("\n", "\r\n").encode(),
        PIECES["IMPORTS"] + TANH.format(WRITES) + "print('hello'); sys.stdin.read()",
        RIGHT + PIECES["REPLACES_MODULES"],
        RIGHT + TO_ALL.format(b'{"defined": ["tanh"]}\n') + "\nos.closerange(3, 1000)",
        RIGHT + PIECES["WAITS"],
    ],
    ids=["marks", "output", "modules", "open files", "unfinished work"],
)
def test_what_harms_nobody_costs_no_points(graded, content):
    file = graded(content)
    assert file.held and (file.points, file.possible) == (10, 10), str(file)


@pytest.mark.parametrize(
    "attempt", [PIECES["REPLACES_TESTS"], PIECES["CHEAT"]], ids=["functions", "results"]
)
def test_a_wrong_function_gets_no_points_by_replacing_what_tests_use(graded, attempt):
    file = graded(WRONG + attempt)
    assert not file.held and file.points <= 4 and file.possible == 10, str(file)


@pytest.mark.skipif(not has_filter(), reason="needs a filter of system calls")
def test_a_file_cannot_fork(graded):
    assert graded(RIGHT + FORKS).points == 10


def notebook(**sources) -> str:
    """A notebook of lesson 03 with an exercise cell of each name, and the check of conv1d."""
    cells = [{"grade_id": name, "solution": True} for name in sources]
    cells.append({"grade_id": "conv1d_check", "grade": True})
    code_cells = [
        {"cell_type": "code", "metadata": {"nbgrader": marks}, "source": source}
        for marks, source in zip(cells, [*sources.values(), "1 / 0"], strict=True)
    ]
    return json.dumps({"cells": code_cells})


def test_each_exercise_of_a_notebook_counts_whatever_the_others_do(graded):
    hostile = "def transpose_filters(w):\n    import os; os._exit(0)\n"
    content = notebook(
        conv1d_by_loops="def conv1d_by_loops(",
        unfold=f"%time\n{inspect.getsource(unfold)}",
        transpose_filters=hostile,
    )
    file = graded(content, "week3.ipynb")
    points = {report.operation: (report.points, report.possible) for report in file.reports}
    assert points["unfold"] == (10, 10)
    assert [points[n][0] for n in ("conv1d_by_loops", "transpose_filters", "conv1d")] == [0, 0, 0]
    assert file.possible == 80  # although the cell of conv1d was deleted
    assert file.faults[0].startswith("cell conv1d_by_loops: SyntaxError")
    broken = graded("{", "03_convolution_by_hand.ipynb")
    assert (broken.points, broken.possible) == (0, 80)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("[" * 10**5, "not a Jupyter notebook"),
        ('{"cells": [{"cell_type": "code", "metadata": null, "source": ""}]}', "not a Jupyter"),
        ('{"cells": {"a": 1}}', "not a Jupyter"),
        (b"\xff\xfe{}", "not a Jupyter"),
        (notebook(tanh=5), "not a Jupyter"),
        (" " * (2**25 + 1), "larger than 32 MB"),
    ],
)
def test_what_is_no_notebook_is_refused(tmp_path, content, problem):
    path = tmp_path / "lesson.ipynb"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert problem in read_submission(path).fault


def test_a_notebook_may_begin_with_a_mark_and_hold_half_of_a_character(graded):
    content = notebook(conv1d="x = '\ud800'", unfold="def unfold(x, taps):\n    return x")
    file = graded(b"\xef\xbb\xbf" + content.encode(), "week3.ipynb")
    assert file.possible == 80 and "cell conv1d: UnicodeEncodeError" in file.faults[0]


def test_a_folder_and_a_device_are_no_files(tmp_path):
    assert grading.grade(tmp_path).faults == ["it is no file"]
    os.mkfifo(tmp_path / "pipe.py")
    assert grading.grade(tmp_path / "pipe.py").faults == ["it is no file"]
