"""Grading of a student's file: every function in it is tested for its properties."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path

from numpy_cae.verify.catalogue import Catalogue, find_task
from numpy_cae.verify.reporting import WIDTH, Report, failed_report, report_from_reply, visible
from numpy_cae.verify.sandbox.process import run

TIME_LIMIT = 120.0
EXERCISE_SECONDS = 30.0
"""CPU time of one exercise; twice as much may pass on the clock."""
MEMORY_LIMIT = 2048


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
    catalogue: str = "numpy_cae.verify.catalogue",
    named: Mapping[str, str] | None = None,
    seconds: float = TIME_LIMIT,
    megabytes: int = MEMORY_LIMIT,
    lesson: str = "",
    any_convention: bool = False,
) -> FileReport:
    """Run a student's file in processes of its own and test its functions.

    Parameters
    ----------
    path : Path
        A Python file, whose functions with the name of an operation are tested; or a lesson's
        notebook, whose exercise cells are tested.
    catalogue : str
        The module whose `CATALOGUE` lists what is tested; its `ASSIGNMENTS`, if it has them, the
        names in each lesson.
    named : mapping of operation to function name, optional
        Functions with other names.
    seconds, megabytes : number
        Limits of the whole file, and of the memory of one process. The memory limit is enforced
        on Linux.
    lesson : str
        The assignment, such as "03": all of its exercises are tested, and count, whether the file
        has them or not. By default that of a notebook's cells or of a name such as 03_mine.py; a
        file that belongs to no lesson is tested for the functions that it has.
    any_convention : bool
        Whether another documented convention than that of `numpy_cae.ops` may be followed.

    Returns
    -------
    FileReport
        Whatever the file does.

    Raises
    ------
    ValueError
        If `named` has a name that the catalogue lacks, or there is no such lesson.
    """
    module = import_module(catalogue)
    for operation in named or ():
        find_task(module.CATALOGUE, operation)
    lessons = getattr(module, "ASSIGNMENTS", {})
    if lesson and lesson not in lessons:
        raise ValueError(f"there is no lesson {lesson!r}; there are {', '.join(lessons)}")
    graded = FileReport(path)
    if not path.is_file():
        graded.faults.append("it is no file" if path.exists() else "there is no such file")
        return graded
    request = {"path": str(path.resolve()), "catalogue": catalogue, "named": dict(named or {})}
    request |= {"seconds": seconds, "exercise_seconds": EXERCISE_SECONDS}
    request |= {"megabytes": megabytes, "lesson": lesson, "any_convention": any_convention}
    reply = run(request)
    graded.faults += [visible(fault) for fault in reply["faults"]]
    for result in reply["results"]:
        graded.reports.append(_report(module.CATALOGUE, result))
        graded.notes += [f"{result['function']}: {visible(n)}" for n in result.get("notes", ())]
    return graded


def _report(catalogue: Catalogue, result: dict) -> Report:
    """The report of one task, from what the process that tested it sent."""
    task, function = catalogue[result["task"]], result["function"]
    if "failed" in result:
        return failed_report(task, function, visible(str(result["failed"])))
    try:
        return report_from_reply(task, function, result["report"])
    except (ValueError, KeyError) as error:
        return failed_report(
            task, function, f"its process sent something that is no reply: {error}"
        )
