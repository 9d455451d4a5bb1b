"""Grading of a student's file: every function in it is tested for its properties."""

import textwrap
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path

from numpy_cae.verify.grading.report import WIDTH, Report, report_from_reply, visible
from numpy_cae.verify.grading.sandbox.process import run
from numpy_cae.verify.grading.submission import Submission, read_submission
from numpy_cae.verify.operations.catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.operations.catalogue import Catalogue, find_task

TIME_LIMIT = 120.0
EXERCISE_SECONDS = 30.0
"""CPU time of one exercise; twice as much may pass on the clock."""
MEMORY_LIMIT = 2048
OPERATIONS_ALONE = "numpy_cae.verify.operations.catalogue"
HELPER = "{} is called by other functions and is no operation itself: it was not tested"
MISSING = (
    f"no function has an operation's name ({', '.join(OPERATIONS)}); "
    "name one with --as conv1d=my_conv"
)


@dataclass
class FileReport:
    """The reports on a file's functions, what is wrong with the file as a whole, and notes.

    A note, such as a warning of NumPy, costs no points.
    """

    path: Path
    reports: list[Report] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

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
        name = visible(str(self.path))
        parts = [name]
        parts += [str(report) for report in self.reports]
        parts += [textwrap.fill(f"The file fails: {fault}", WIDTH) for fault in self.faults]
        parts += [textwrap.fill(f"Note: {note}", WIDTH) for note in self.notes]
        verdict = "every property held" if self.held else "FAILED"
        score = f"{self.points} of {self.possible} points" if self.possible else "no points"
        parts.append(f"{name}: {score}, {verdict}")
        return "\n\n".join(parts)

    def as_json(self) -> dict:
        """The report in plain dicts, lists and numbers."""
        return {
            "file": str(self.path),
            "points": self.points,
            "possible": self.possible,
            "held": self.held,
            "faults": self.faults,
            "notes": self.notes,
            "operations": [report.as_json() for report in self.reports],
        }


def grade(
    path: Path,
    catalogue: str = OPERATIONS_ALONE,
    named: Mapping[str, str] | None = None,
    seconds: float = TIME_LIMIT,
    megabytes: int = MEMORY_LIMIT,
    lesson: str = "",
    any_convention: bool = False,
) -> FileReport:
    """Run a student's file in processes of its own and test its functions.

    Tested are the functions of a Python file with the name of an operation, or the exercise cells
    of a notebook. `catalogue` is the module with a `CATALOGUE` of what may be tested, and perhaps
    `ASSIGNMENTS`, the names in each lesson; `named` has functions with other names, by operation.
    The limits are those of the whole file, and of the memory of one process (on Linux). All
    exercises of `lesson`, by default that of the cells or of a name such as 03_mine.py, count.

    Raises a ValueError if there is no such operation or lesson.
    """
    module = import_module(catalogue)
    named = dict(named or {})
    for operation in named:
        find_task(module.CATALOGUE, operation)
    lessons = getattr(module, "ASSIGNMENTS", {})
    if lesson and lesson not in lessons:
        raise ValueError(f"there is no lesson {lesson!r}; there are {', '.join(lessons)}")
    submission = read_submission(path)
    assigned = lessons.get(lesson or submission.lesson(lessons), ())
    known = assigned or (module.CATALOGUE if submission.is_notebook else OPERATIONS)
    wanted = {name: name for name in known} | named
    reply = {"failed": submission.fault}
    if not submission.fault:
        own = assigned or submission.defined() & wanted.keys()
        given = {name for task in own for name in module.CATALOGUE[task].given} - set(assigned)
        if {*wanted, *given} <= OPERATIONS.keys():
            catalogue = OPERATIONS_ALONE  # quicker to import
        request = {"path": str(path.resolve()), "from": catalogue, "any_convention": any_convention}
        request["replaced"] = list(assigned) if submission.is_notebook else []
        request |= {"wanted": wanted, "given": sorted(given), "megabytes": megabytes}
        reply = run(request | {"seconds": seconds, "cpu_seconds": EXERCISE_SECONDS})
    return _graded(submission, module.CATALOGUE, wanted, {*assigned, *named}, reply)


def _graded(
    submission: Submission,
    catalogue: Catalogue,
    wanted: Mapping[str, str],
    counted: Collection[str],
    reply: dict,
) -> FileReport:
    """The report from the reply of `run`; `counted` are the tasks that count in any case."""
    graded, results = FileReport(submission.path), reply.get("results", {})
    problems, fault = reply.get("problems", []), reply["failed"]
    if problems and not submission.is_notebook:
        fault = problems[0]
    defined = submission.defined() if fault else ()
    helpers: list[Report] = []
    for task, function in wanted.items():
        if not (task in results or task in counted or function in defined):
            continue
        result = results.get(task, {"failed": f"it has no function {function}"})
        result = {"failed": fault} if fault else result
        report = report_from_reply(catalogue[task], function, result)
        if task not in counted and _is_helper(report, submission):
            helpers.append(report)
            continue
        graded.reports.append(report)
        graded.notes += [f"{function}: {visible(note)}" for note in result.get("notes", ())]
    if graded.reports:
        graded.notes += [HELPER.format(report.called) for report in helpers]
    graded.reports = graded.reports or helpers
    missing = [] if graded.reports else [MISSING]
    graded.faults += map(visible, [fault] if fault else problems + missing)
    return graded


def _is_helper(report: Report, submission: Submission) -> bool:
    """Whether a function shares its name with an operation, but not its arguments or results."""
    return "TypeError" in report.outcomes[0].problem and submission.calls(report.called)
