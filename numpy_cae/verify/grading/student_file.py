"""Grading of a student's file: every function in it is tested for its properties.

A process tests them, which is ended in time.
"""

import functools
import json
import os
import shutil
import subprocess
import sys
import tempfile
import textwrap
import time
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from threading import Thread
from types import ModuleType
from typing import Any

from numpy_cae.verify.grading.report import UNSOLVED, WIDTH, Report, make_readable, report_of
from numpy_cae.verify.grading.submission import Submission, read_submission
from numpy_cae.verify.operations import operation_catalogue
from numpy_cae.verify.operations.operation_catalogue import CATALOGUE, Exercise

TIME_LIMIT = 30.0
"""One function has this processor time (s) by default; it may be idle as long again."""
MEMORY_LIMIT = 2048
"""Each process has this memory (MB) by default."""

Exercises = Mapping[str, Exercise]
Reply = dict[str, Any]
"""What the grader's process sends: `sandbox.reply_to` makes it."""


@dataclass
class FileReport:
    """The reports on a file's functions, what is wrong with the file as a whole, and notes.

    A note costs no points, such as that the cell of an exercise was copied. `ungraded` says why the
    file could not be graded, for no fault of its own: then it has no marks, and no points.
    """

    path: Path
    reports: list[Report] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    copied: tuple[str, ...] = ()
    ungraded: str = ""

    @property
    def held(self) -> bool:
        return not self.faults and not self.ungraded and all(report.held for report in self.reports)

    @property
    def points(self) -> int:
        return sum(report.points for report in self.reports)

    @property
    def possible(self) -> int:
        return sum(report.possible for report in self.reports)

    def __str__(self) -> str:
        name = make_readable(str(self.path))
        if self.ungraded:
            return f"{name}: NOT GRADED, {self.ungraded}. Grade it again."
        notes = [f"The file fails: {fault}" for fault in self.faults]
        notes += [f"Note: {note}" for note in self.notes]
        verdict = "every property held" if self.held else "FAILED"
        score = f"{self.points} of {self.possible} points" if self.possible else "no points"
        parts = [name]
        parts += [str(report) for report in self.reports]
        parts += [textwrap.fill(note, WIDTH) for note in notes]
        parts.append(f"{name}: {score}, {verdict}")
        return "\n\n".join(parts)


def grade(
    path: Path,
    catalogue: ModuleType = operation_catalogue,
    seconds: float = TIME_LIMIT,
    megabytes: int = MEMORY_LIMIT,
    lesson: str = "",
) -> FileReport:
    """Run a student's file in processes of its own and test its functions.

    Tested are the functions of a Python file that have the name of an operation, or what the
    catalogue's `read_submission` finds in a notebook.

    Parameters
    ----------
    path : Path
    catalogue : module
        With the `CATALOGUE` of what may be tested; perhaps `ASSIGNMENTS`, the names of the
        exercises in each lesson, and `read_submission`, which reads more than Python files. The
        processes import the module by its name.
    seconds : float
        Limit of the processor time of one function.
    megabytes : int
        Limit of the memory of one process (on Linux).
    lesson : str
        The lesson whose exercises all count; by default that to which the file belongs.

    Returns
    -------
    FileReport

    Raises
    ------
    ValueError
        If there is no such lesson.
    """
    exercises: Exercises = catalogue.CATALOGUE
    lessons = getattr(catalogue, "ASSIGNMENTS", {})
    if lesson and lesson not in lessons:
        raise ValueError(f"there is no lesson {lesson!r}; there are {', '.join(lessons)}")
    submission: Submission = getattr(catalogue, "read_submission", read_submission)(path)
    assigned = lessons.get(lesson or submission.lesson, ())
    if assigned:
        names = list(assigned)
    elif submission.is_notebook:
        names = list(exercises)
    else:
        names = list(CATALOGUE)
    requested = {name: exercises[name] for name in names}
    if submission.fault:
        return _report_on(submission, requested, assigned, {"failed": submission.fault})
    provided = _names_provided(submission, requested, assigned)
    if {*requested, *provided} <= CATALOGUE.keys():
        catalogue = operation_catalogue  # quicker to import
    request = {
        "path": str(path.resolve()),
        "cells": _cells_of_request(submission),
        "is_notebook": submission.is_notebook,
        "catalogue": catalogue.__name__,
        "requested": names,
        "provided": provided,
        "replaced": assigned if submission.is_notebook else (),
        "seconds": seconds,
        "megabytes": megabytes,
    }
    return _report_on(submission, requested, assigned, run(request))


def _cells_of_request(submission: Submission) -> list[tuple[str, str]]:
    """The cells as JSON can hold them: the bytes of a Python file as characters, no name."""
    cells = []
    for name, source in submission.cells:
        if isinstance(source, bytes):
            cells.append(("", source.decode("latin-1")))
        else:
            cells.append((name, source))
    return cells


def _names_provided(
    submission: Submission, requested: Exercises, assigned: Collection[str]
) -> list[str]:
    """What the exercises that are tested may call without defining it."""
    tested = assigned or submission.functions_defined() & requested.keys()
    provided: set[str] = set()
    for name in tested:
        provided.update(requested[name].provided)
    return sorted(provided - set(assigned))


HELPER = "{} is called by other functions and is no operation itself: it was not tested"
MISSING = (
    "no function has an operation's name (exercises of a lesson need --lesson NN): "
    f"{', '.join(CATALOGUE)}"
)


def _report_on(
    submission: Submission, requested: Exercises, assigned: Collection[str], reply: Reply
) -> FileReport:
    """The report from the reply of `run` on the requested exercises, by name.

    Those that are assigned count in any case.
    """
    if "ungraded" in reply:
        return FileReport(submission.path, ungraded=make_readable(reply["ungraded"]))
    problems = reply.get("problems", [])
    fault = reply["failed"]
    if not fault and problems and not submission.is_notebook:
        fault = problems[0]
    reports = _reports_on(submission, requested, assigned, reply.get("results", {}), fault)
    file = FileReport(submission.path, copied=submission.copied)
    file.notes += submission.notes
    helpers = [r for r in reports if r.operation not in assigned and _is_helper(r, submission)]
    if len(helpers) < len(reports):
        file.notes += [HELPER.format(report.called) for report in helpers]
        file.reports = [report for report in reports if report not in helpers]
    else:
        file.reports = reports
    if fault:
        file.faults.append(make_readable(fault))
        return file
    file.faults += [make_readable(problem) for problem in problems]
    if not file.reports:
        file.faults.append(make_readable(MISSING))
    return file


def _reports_on(
    submission: Submission,
    requested: Exercises,
    assigned: Collection[str],
    results: Mapping[str, Reply],
    fault: str,
) -> list[Report]:
    """The reports on what was tested or assigned; a fault fails all that the file defines."""
    counted = {*results, *assigned}
    if fault:
        counted |= submission.functions_defined()
    reports = []
    for name, exercise in requested.items():
        if name not in counted:
            continue
        if fault:
            result: Reply = {"failed": fault}
        else:
            result = results.get(name, {"failed": f"it has no function {name}"})
        reports.append(report_of(exercise, result))
    return reports


def _is_helper(report: Report, submission: Submission) -> bool:
    """Whether others call a function with an operation's name that answers in no case."""
    first, *further = report.outcomes
    answers = first.kind in ("", UNSOLVED)
    answers = answers or any(outcome.held or outcome.problem for outcome in further)
    return not answers and submission.calls(report.called)


PREFIX = "numpy_cae_grading_"


def run(request: dict[str, Any]) -> Reply:
    """The reply of `sandbox.main` to a request; `ungraded` says why there is none."""
    try:
        with tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True) as folder:
            os.chmod(folder, 0o711)  # another user may have a folder in it
            text, problem = _answer_of_process(json.dumps(request), folder, _timeout(request))
    except OSError as error:
        return {"failed": "", "ungraded": f"its grader could not start: {error}"}
    if not problem:
        with suppress(ValueError):
            return json.loads(text)
        problem = "its grader ended without a reply: was it killed?"
    return {"failed": "", "ungraded": problem}


STARTUP_SECONDS = 30.0
"""The grader's process may take this time (s) to import its modules."""
BUSY = 10
"""The grader itself is ended after so many times the limits of all functions.

The limits that decide on marks do not count the time in which a process waits for a processor.
"""


def _timeout(request: Reply) -> float:
    """The seconds after which a grader is ended, whatever it does."""
    return BUSY * (2 * request["seconds"] * len(request["requested"]) + STARTUP_SECONDS)


PROJECT = str(Path(__file__).parents[3])
PASSED_ON = ("PATH", "HOME", "SYSTEMROOT", "LD_LIBRARY_PATH", "LANG")
"""The environment variables that the grader's process gets."""
LIBRARIES = ("OPENBLAS", "OMP", "MKL", "BLIS")
ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in LIBRARIES}
CHILD = [sys.executable, "-B", "-P", "-m", "numpy_cae.confined", "numpy_cae.verify.grading.sandbox"]


def _answer_of_process(request: str, folder: str, timeout: float) -> tuple[str, str]:
    """The last line that the grader's process writes, and why it was ended, or ""."""
    environment = {name: os.environ[name] for name in PASSED_ON if name in os.environ} | ONE_THREAD
    environment["PYTHONPATH"] = os.pathsep.join([PROJECT, os.environ.get("PYTHONPATH", "")])
    environment["TMPDIR"] = folder
    command = CHILD
    if has_bubblewrap():
        command = [*BUBBLEWRAP, "--bind", folder, folder, *CHILD]
    lines: list[str] = [""]
    with subprocess.Popen(
        command,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        cwd=folder,
        env=environment,
        start_new_session=True,
        text=True,
    ) as process:

        def exchange() -> None:
            assert process.stdin is not None and process.stdout is not None
            with suppress(OSError):  # it has ended
                process.stdin.write(request)
                process.stdin.close()
            for line in process.stdout:
                lines.append(line)

        exchanging = Thread(target=exchange, daemon=True)
        exchanging.start()
        problem = _wait(exchanging, lines, timeout)
        if problem:
            process.kill()
        exchanging.join()
    return lines[-1], problem


SILENT_SECONDS = 60.0
"""A grader that says nothing for so long (s) was stopped, and is ended. It says that it runs once a
second; a machine with sixty processes a processor is not silent for longer."""
LOOK_SECONDS = 2.0
"""So often it is looked whether a grader says something."""


def _wait(exchanging: Thread, lines: list[str], timeout: float) -> str:
    """Wait for the end of an exchange; why the process has to be ended before, or "".

    The grader writes a line each second. If it does not while this process is awake for so many
    looks, somebody has stopped it.
    """
    begun = time.monotonic()
    silent_looks = 0
    while exchanging.is_alive():
        count = len(lines)
        exchanging.join(LOOK_SECONDS)
        silent_looks = 0 if len(lines) > count else silent_looks + 1
        if silent_looks * LOOK_SECONDS > SILENT_SECONDS:
            return f"its grader did nothing for {SILENT_SECONDS:g} s: was it stopped?"
        if time.monotonic() - begun > timeout:
            return f"its grading took more than {timeout:.0f} s"
    return ""


BUBBLEWRAP = "bwrap --ro-bind / / --dev /dev --proc /proc --unshare-all --die-with-parent".split()


@functools.cache
def has_bubblewrap() -> bool:
    """Whether bubblewrap is installed and works here; it needs namespaces of its user."""
    if shutil.which("bwrap") is None:
        return False
    return subprocess.run([*BUBBLEWRAP, "true"], capture_output=True).returncode == 0
