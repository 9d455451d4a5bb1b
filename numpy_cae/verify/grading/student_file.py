"""Grading of a student's file: every function in it is tested for its properties."""

import textwrap
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType

from numpy_cae.verify.grading.report import UNSOLVED, WIDTH, Report, readable, report_of
from numpy_cae.verify.grading.sandbox.process import run
from numpy_cae.verify.grading.submission import Submission, read_submission
from numpy_cae.verify.operations import catalogue as operations
from numpy_cae.verify.operations.catalogue import Exercise

TIME_LIMIT = 30.0
"""TIME_LIMIT: one function has this processor time (s) by default; it may be idle as long again."""
MEMORY_LIMIT = 2048
"""MEMORY_LIMIT: each process has this memory (MB) by default."""
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
    tested = assigned or (exercises if submission.is_notebook else operations.CATALOGUE)
    wanted = [*tested]
    reply = {"failed": submission.fault}
    if not submission.fault:
        tested = assigned or submission.defined() & {*wanted}
        given = {other for name in tested for other in exercises[name].given} - set(assigned)
        if {*wanted, *given} <= operations.CATALOGUE.keys():
            catalogue = operations  # quicker to import
        file = {"path": str(path.resolve()), "catalogue": catalogue.__name__, "wanted": wanted}
        file |= {"given": sorted(given), "replaced": assigned if submission.is_notebook else ()}
        reply = run({**file, "seconds": seconds, "megabytes": megabytes})
    return _graded(submission, exercises, wanted, assigned, reply)


def _graded(
    submission: Submission,
    catalogue: Mapping[str, Exercise],
    wanted: Collection[str],
    assigned: Collection[str],
    reply: dict,
) -> FileReport:
    """The report from the reply of `run`; what is assigned counts in any case."""
    graded = FileReport(submission.path, copied=submission.copied)
    graded.notes += [COPIED.format(name) for name in submission.copied]
    results = reply.get("results", {})
    problems = reply.get("problems", [])
    fault = reply["failed"] or (problems[0] if problems and not submission.is_notebook else "")
    defined = submission.defined() if fault else ()
    helpers: list[Report] = []
    for name in wanted:
        if not (name in results or name in assigned or name in defined):
            continue
        result = results.get(name, {"failed": f"it has no function {name}"})
        result = {"failed": fault} if fault else result
        report = report_of(catalogue[name], result)
        if name not in assigned and _is_helper(report, submission):
            helpers.append(report)
        else:
            graded.reports.append(report)
    if graded.reports:
        graded.notes += [HELPER.format(report.called) for report in helpers]
    graded.reports = graded.reports or helpers
    missing = [] if graded.reports else [MISSING]
    graded.faults += map(readable, [fault] if fault else problems + missing)
    return graded


def _is_helper(report: Report, submission: Submission) -> bool:
    """Whether others call a function with an operation's name that answers in no case."""
    first, *others = report.outcomes
    answers = first.kind in ("", UNSOLVED) or any(one.held or one.problem for one in others)
    return not answers and submission.calls(report.called)
