"""The system refuses what hostile files try, and nothing that they change in their process counts.

docs/grading_files.md says what holds where the kernel has neither Landlock nor such filters.
"""

import os
import re
import signal
import sys
import time
from pathlib import Path
from subprocess import PIPE, Popen, run
from threading import Thread

import pytest
from hostile_actions import ACTIONS, BEGINNING, PATCHES

import numpy_cae
from numpy_cae.confined.confinement import has_filter, landlock_version
from numpy_cae.confined.template import can_fork
from numpy_cae.course import submitted_file
from numpy_cae.course.catalogue import read_submission
from numpy_cae.verify.grading import student_file, student_process
from numpy_cae.verify.grading.sandbox import reply_to

RIGHT = """
def tanh(x):
    y = np.tanh(x)
    return y, lambda dy: dy * (1 - y * y)
"""
CONSTANT = """
def tanh(x):
    return 0 * x + 0.3, lambda dy: 0 * dy
"""
KILLED_IN_ITS_CASES = """
import os
import numpy as np


def tanh(x):
    open("pid", "w").write(str(os.getpid()))
    while True:
        pass
"""

is_confined = pytest.mark.skipif(
    not (landlock_version() and has_filter()), reason="this kernel has no Landlock or no filters"
)


@pytest.fixture
def outside(tmp_path):
    """A folder beside that of the student's file, with a file in it."""
    folder = tmp_path / "outside"
    folder.mkdir()
    (folder / "victim").write_text("text")
    return folder


def state_of(folder: Path) -> list:
    """The names, contents, modes and times in a folder."""
    states = []
    for path in sorted(folder.iterdir()):
        status = path.stat()
        states.append((path.name, path.read_text(), status.st_mode, status.st_mtime_ns))
    return states


@is_confined
@pytest.mark.parametrize("name", ACTIONS)
def test_the_system_refuses(name, graded, outside, tmp_path):
    root = Path(numpy_cae.__file__).parent
    places = f"SOURCE = {str(root / 'ops' / 'activations.py')!r}\nROOT = {str(root.parent)!r}\n"
    before = state_of(outside)
    content = BEGINNING.format(outside=str(outside)) + places + ACTIONS[name] + RIGHT
    file = graded(content, "work/student.py")
    assert re.search("PermissionError|OperationalError|RunFailedError|refused|not there", str(file))
    assert "DONE" not in str(file)
    assert state_of(outside) == before
    shared_memory = Path("/dev/shm", str(outside).replace("/", "_"))
    is_shared = shared_memory.exists()
    shared_memory.unlink(missing_ok=True)  # it would stay until the machine is started again
    assert not is_shared


@pytest.mark.parametrize("name", PATCHES)
def test_what_a_file_changes_in_its_process_earns_nothing(name, graded):
    file = graded("import gc\nimport numpy as np\n" + PATCHES[name] + CONSTANT)
    assert not file.held
    assert file.points == 0


@pytest.fixture
def request_for(tmp_path, monkeypatch):
    """A request to grade a file of this content, in the current folder."""
    monkeypatch.chdir(tmp_path)

    def make(content: str) -> dict:
        path = tmp_path / "student.py"
        path.write_text(content)
        return {
            "path": str(path),
            "cells": [["", content]],
            "is_notebook": False,
            "catalogue": "numpy_cae.verify.operations.operation_catalogue",
            "requested": ["tanh"],
            "provided": [],
            "replaced": [],
            "seconds": 20.0,
            "megabytes": 2048,
        }

    return make


@pytest.fixture(params=["a program", "a fork of the template"])
def grade_request(request, forked_grading):
    """Does a request, with either kind of process for the student's file."""
    return reply_to if request.param == "a program" else student_file.run


def kill_when_it_runs(folder: Path) -> None:
    """Wait until a student's file has written the number of its process, and kill that."""
    number = ""
    while not number:
        time.sleep(0.01)
        for path in folder.glob("*/pid"):
            number = path.read_text()
    os.kill(int(number), signal.SIGKILL)


@is_confined
def test_a_process_that_is_killed_from_outside_is_said_to_be(request_for, grade_request, tmp_path):
    request = request_for(KILLED_IN_ITS_CASES)
    killer = Thread(target=kill_when_it_runs, args=[tmp_path], daemon=True)
    killer.start()
    assert grade_request(request)["ungraded"] == student_process.KILLED


@is_confined
def test_a_loop_ends_by_its_time(request_for, grade_request):
    request = request_for(KILLED_IN_ITS_CASES) | {"seconds": 1.0}
    failed = grade_request(request)["results"]["tanh"]["failed"]
    assert failed.endswith("an endless loop?")


def test_a_full_disk_is_no_fault_of_the_file(request_for, monkeypatch):
    def mkdtemp(**options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(student_process.tempfile, "mkdtemp", mkdtemp)
    assert "No space left" in reply_to(request_for("import numpy as np" + RIGHT))["ungraded"]


@pytest.mark.parametrize(
    ("program", "silent_seconds", "reason"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", 60.0, "ended without a reply"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSTOP)", 0.2, "was it stopped?"),
    ],
    ids=["killed", "stopped"],
)
def test_a_grader_that_is_ended_or_stopped_is_said_to_be(
    program, silent_seconds, reason, tmp_path, monkeypatch
):
    monkeypatch.setattr(student_file, "CHILD", [sys.executable, "-c", program])
    monkeypatch.setattr(student_file, "SILENT_SECONDS", silent_seconds)
    monkeypatch.setattr(student_file, "LOOK_SECONDS", 0.1)
    path = tmp_path / "student.py"
    path.write_text("import numpy as np\n" + RIGHT)
    file = student_file.grade(path)
    assert reason in file.ungraded
    assert "NOT GRADED" in str(file)
    assert not file.held


def test_a_notebook_of_many_cells_is_read_in_linear_time(tmp_path, monkeypatch):
    """Counts how often the text of a cell is looked at: a few times, whatever the number."""
    counts = []
    source_of = submitted_file._source

    def count_source(cell):
        counts[-1] += 1
        return source_of(cell)

    monkeypatch.setattr(submitted_file, "_source", count_source)
    cell = '{"cell_type": "code", "metadata": {"nbgrader": {"grade_id": "c%d", "solution": true}},'
    cell += '"source": "def c%d(): pass"}'
    for number in (100, 1000):
        counts.append(0)
        path = tmp_path / f"{number}.ipynb"
        cells = ",".join(cell % (n, n) for n in range(number))
        path.write_text('{"cells": [' + cells + "]}")
        assert len(read_submission(path).cells) == number
    assert counts[1] == 10 * counts[0]


@is_confined
def test_processes_that_ran_before_the_grading_go_on(request_for):
    with Popen([sys.executable, "-c", "import sys; sys.stdin.read()"], stdin=PIPE) as earlier:
        reply_to(request_for(CONSTANT))
        assert earlier.poll() is None


@pytest.mark.skipif(not can_fork(), reason="there is no template here")
def test_what_a_file_has_started_ends_with_its_process(tmp_path):
    program = Path(__file__).with_name("program_of_a_file.py")
    output = run([sys.executable, program, tmp_path], capture_output=True, text=True, check=True)
    assert output.stdout.split() == ["True", "False"]
