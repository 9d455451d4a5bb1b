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
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

from numpy_cae.verify.grading.report import UNSOLVED, WIDTH, Report, readable, report_of
from numpy_cae.verify.grading.submission import Submission, read_submission
from numpy_cae.verify.operations import catalogue as operations

TIME_LIMIT = 30.0
"""TIME_LIMIT: one function has this processor time (s) by default; it may be idle as long again."""
MEMORY_LIMIT = 2048
"""MEMORY_LIMIT: each process has this memory (MB) by default."""
STARTUP_SECONDS = 30.0
"""STARTUP_SECONDS: the grader's process may take this time (s) to import its modules."""
BUSY = 10
"""BUSY: the grader itself is ended after so many times the limits of all functions.

The limits that decide on marks do not count the time in which a process waits for a processor. This
one is for a grader that a student's file has stopped.
"""
PREFIX = "numpy_cae_grading_"
PROJECT = str(Path(__file__).parents[3])
KEPT = ("PATH", "HOME", "SYSTEMROOT", "LD_LIBRARY_PATH", "LANG")
LIBRARIES = ("OPENBLAS", "OMP", "MKL", "BLIS")
ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in LIBRARIES}
CHILD = [sys.executable, "-B", "-m", "numpy_cae.verify.grading.sandbox"]
BUBBLEWRAP = "bwrap --ro-bind / / --dev /dev --proc /proc --unshare-all --die-with-parent".split()
HELPER = "{} is called by other functions and is no operation itself: it was not tested"
COPIED = "the cell of {} is there more than once: the last one counts"
MISSING = "no function has an operation's name (exercises of a lesson need --lesson NN): "
MISSING += ", ".join(operations.CATALOGUE)


@dataclass
class FileReport:
    """The reports on a file's functions, what is wrong with the file as a whole, and notes.

    A note costs no points, such as that the cell of an exercise was copied.
    """

    path: Path
    reports: list[Report] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    copied: tuple[str, ...] = ()

    @property
    def held(self) -> bool:
        return not self.faults and all(report.held for report in self.reports)

    @property
    def points(self) -> int:
        return sum(report.points for report in self.reports)

    @property
    def possible(self) -> int:
        return sum(report.possible for report in self.reports)

    def __str__(self) -> str:
        name = readable(str(self.path))
        notes = [f"The file fails: {fault}" for fault in self.faults]
        notes += [f"Note: {note}" for note in self.notes]
        verdict = "every property held" if self.held else "FAILED"
        score = f"{self.points} of {self.possible} points" if self.possible else "no points"
        filled = [textwrap.fill(note, WIDTH) for note in notes]
        return "\n\n".join([name, *map(str, self.reports), *filled, f"{name}: {score}, {verdict}"])


def grade(
    path: Path,
    catalogue: ModuleType = operations,
    seconds: float = TIME_LIMIT,
    megabytes: int = MEMORY_LIMIT,
    lesson: str = "",
) -> FileReport:
    """Run a student's file in processes of its own and test its functions.

    Tested are the functions of a Python file that have the name of an operation, or the exercise
    cells of a notebook.

    Parameters
    ----------
    path : Path
    catalogue : module
        With the `CATALOGUE` of what may be tested, and perhaps `ASSIGNMENTS`, the names of the
        exercises in each lesson. The processes import the module by its name.
    seconds : float
        Limit of the processor time of one function.
    megabytes : int
        Limit of the memory of one process (on Linux).
    lesson : str
        The lesson whose exercises all count; by default that of the cells or of the file's name,
        such as 03_mine.py.

    Returns
    -------
    FileReport

    Raises
    ------
    ValueError
        If there is no such lesson.
    """
    exercises = catalogue.CATALOGUE
    lessons = getattr(catalogue, "ASSIGNMENTS", {})
    if lesson and lesson not in lessons:
        raise ValueError(f"there is no lesson {lesson!r}; there are {', '.join(lessons)}")
    submission = read_submission(path)
    assigned = lessons.get(lesson or submission.lesson(lessons), ())
    wanted = [*(assigned or (exercises if submission.is_notebook else operations.CATALOGUE))]
    reply = {"failed": submission.fault}
    if not submission.fault:
        tested = assigned or submission.defined() & {*wanted}
        given = {other for name in tested for other in exercises[name].given} - set(assigned)
        if {*wanted, *given} <= operations.CATALOGUE.keys():
            catalogue = operations  # quicker to import
        file = {"path": str(path.resolve()), "catalogue": catalogue.__name__, "wanted": wanted}
        file |= {"given": sorted(given), "replaced": assigned if submission.is_notebook else ()}
        reply = run({**file, "seconds": seconds, "megabytes": megabytes})
    return _graded(submission, {name: exercises[name] for name in wanted}, assigned, reply)


def _graded(submission: Submission, wanted: dict, assigned: Collection, reply: dict) -> FileReport:
    """The report from the reply of `run` on the wanted exercises, by name.

    Those that are assigned count in any case.
    """
    graded = FileReport(submission.path, copied=submission.copied)
    graded.notes += [COPIED.format(name) for name in submission.copied]
    results = reply.get("results", {})
    problems = reply.get("problems", [])
    fault = reply["failed"] or (problems[0] if problems and not submission.is_notebook else "")
    counted = {*results, *assigned, *(submission.defined() if fault else ())}
    for name in (name for name in wanted if name in counted):
        failed = {"failed": fault or f"it has no function {name}"}
        result = failed if fault else results.get(name, failed)
        graded.reports.append(report_of(wanted[name], result))
    others = [report for report in graded.reports if report.operation not in assigned]
    helpers = [report for report in others if _is_helper(report, submission)]
    if len(helpers) < len(graded.reports):
        graded.notes += [HELPER.format(report.called) for report in helpers]
        graded.reports = [report for report in graded.reports if report not in helpers]
    missing = [] if graded.reports else [MISSING]
    graded.faults += map(readable, [fault] if fault else problems + missing)
    return graded


def _is_helper(report: Report, submission: Submission) -> bool:
    """Whether others call a function with an operation's name that answers in no case."""
    first, *others = report.outcomes
    answers = first.kind in ("", UNSOLVED) or any(one.held or one.problem for one in others)
    return not answers and submission.calls(report.called)


def run(request: dict) -> dict:
    """The reply of `sandbox.main` to a request, or {"failed": why}."""
    environment = {name: os.environ[name] for name in KEPT if name in os.environ} | ONE_THREAD
    environment["PYTHONPATH"] = os.pathsep.join([PROJECT, os.environ.get("PYTHONPATH", "")])
    processes = len(request["wanted"]) + 1
    timeout = BUSY * (2 * request["seconds"] * processes + STARTUP_SECONDS)
    with tempfile.TemporaryDirectory(prefix=PREFIX, ignore_cleanup_errors=True) as folder:
        environment["TMPDIR"] = folder
        inside = [*BUBBLEWRAP, "--bind", folder, folder] if has_bubblewrap() else []
        options = {"cwd": folder, "env": environment, "start_new_session": True, "timeout": timeout}
        text = json.dumps(request).encode()
        try:
            ended = subprocess.run([*inside, *CHILD], input=text, capture_output=True, **options)
            return json.loads(ended.stdout)
        except (subprocess.TimeoutExpired, ValueError):
            return {"failed": "its grading ended without a reply"}


@functools.cache
def has_bubblewrap() -> bool:
    """Whether bubblewrap is installed and works here; it needs namespaces of its user."""
    if shutil.which("bwrap") is None:
        return False
    return subprocess.run([*BUBBLEWRAP, "true"], capture_output=True).returncode == 0
