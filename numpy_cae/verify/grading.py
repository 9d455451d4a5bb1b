"""A student's file held to the properties of every operation in it."""

from __future__ import annotations

import ast
import tempfile
import textwrap
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from numpy_cae.verify.catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.catalogue import Catalogue, find_task, load_catalogue
from numpy_cae.verify.notebook import exercise_source
from numpy_cae.verify.reporting import WIDTH, Report, report_on
from numpy_cae.verify.sandbox.refusal import refused_imports
from numpy_cae.verify.sandbox.student import Fault, Student

TIME_LIMIT = 120.0
MEMORY_LIMIT = 2048


@dataclass
class FileReport:
    """The reports on a file's functions, and what is wrong with the file as a whole."""

    path: Path
    reports: list[Report] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

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
        parts = [str(self.path)]
        parts += [str(report) for report in self.reports]
        parts += [textwrap.fill(f"The file fails: {fault}", WIDTH) for fault in self.faults]
        verdict = "every property held" if self.held else "FAILED"
        score = f"{self.points} of {self.possible} points" if self.possible else "no points"
        parts.append(f"{self.path}: {score}, {verdict}")
        return "\n\n".join(parts)

    def as_json(self) -> dict:
        """The report in plain dicts, lists and numbers."""
        return {
            "file": str(self.path),
            "points": self.points,
            "possible": self.possible,
            "held": self.held,
            "faults": self.faults,
            "operations": [report.as_json() for report in self.reports],
        }


def grade(
    path: Path,
    catalogue: str = "numpy_cae.verify.catalogue",
    named: Mapping[str, str] | None = None,
    seconds: float = TIME_LIMIT,
    megabytes: int = MEMORY_LIMIT,
) -> FileReport:
    """Run a student's file in a process of its own and hold its functions to their properties.

    Parameters
    ----------
    path : Path
        A Python file: functions that bear an operation's name are tried as that operation. Or a
        lesson's notebook: the functions in its exercise cells are tried as those exercises.
    catalogue : str
        The module whose `CATALOGUE` says what is tested.
    named : mapping of operation to function name, optional
        Functions with other names.
    seconds, megabytes : number
        The limits of the whole file. The memory limit holds where the platform knows one (POSIX).

    Returns
    -------
    FileReport
        Whatever the file does, it ends in a report.

    Raises
    ------
    OSError
        If there is no such file.
    ValueError
        If `named` names an operation that does not exist.
    """
    named = dict(named or {})
    known = load_catalogue(catalogue)
    for operation in named:
        find_task(known, operation)
    graded = FileReport(path)
    text = path.read_bytes()
    if path.suffix == ".ipynb":
        return _grade_notebook(graded, text, known, named, seconds, megabytes)
    _grade_program(graded, path, text, known, list(OPERATIONS), named, seconds, megabytes)
    return graded


def _grade_notebook(graded: FileReport, text: bytes, catalogue: Catalogue, *options) -> FileReport:
    """The exercise cells alone, as a program."""
    try:
        program = exercise_source(text.decode())
    except ValueError as error:
        graded.faults.append(str(error))
        return graded
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "notebook.py")
        path.write_text(program, encoding="utf-8")
        given = _given(program, catalogue)
        known = list(catalogue)
        _grade_program(graded, path, program.encode(), catalogue, known, *options, given=given)
    return graded


def _given(program: str, catalogue: Catalogue) -> dict[str, Callable]:
    """What the exercises that a program solves may call of earlier lessons, as a lesson imports it.

    Never what the program is to define itself.
    """
    try:
        defined = {node.name for node in ast.parse(program).body if hasattr(node, "name")}
    except (SyntaxError, ValueError, RecursionError):  # which grading reports
        return {}
    wanted = {name for own in defined & set(catalogue) for name in catalogue[own].given}
    return {name: catalogue[name].solution for name in wanted - defined}


def _grade_program(
    graded: FileReport,
    path: Path,
    text: bytes,
    catalogue: Catalogue,
    known: list[str],
    named: dict[str, str],
    seconds: float,
    megabytes: int,
    given: Mapping[str, Callable] | None = None,
) -> None:
    """Run a program and try those of its functions whose names are known."""
    try:
        refused = refused_imports(text.decode())
    except (SyntaxError, ValueError, RecursionError) as error:
        graded.faults.append(f"it is not Python: {error}")
        return
    if refused:
        graded.faults.append(
            "refused: the operations are to be written by hand in NumPy, and it imports "
            f'{"; ".join(refused)} (self-tests may, under if __name__ == "__main__":)'
        )
        return
    deadline = time.monotonic() + seconds
    try:
        todo = None
        while todo is None or todo:  # a process that had to be ended is followed by another
            with Student(path, deadline, megabytes) as student:
                student.load(given)
                todo = _functions(set(student.functions), known, named) if todo is None else todo
                while todo and not student.ended:
                    _grade_function(graded, student, catalogue, *todo.pop(0))
    except Fault as fault:
        graded.faults.append(str(fault))


def _functions(there: set[str], known: list[str], named: dict[str, str]) -> list[tuple[str, str]]:
    """Operations and the functions to try as them, of those that the file has."""
    for operation, function in named.items():
        if function not in there:
            raise Fault(f"it has no function {function} to try as {operation}")
    wanted = {name: name for name in known if name in there} | named
    if not wanted:
        raise Fault(
            f"no function bears an operation's name ({', '.join(OPERATIONS)}); "
            "name one with --as conv1d=my_conv"
        )
    return list(wanted.items())


def _grade_function(
    graded: FileReport, student: Student, catalogue: Catalogue, operation: str, function: str
) -> None:
    tried = student.function(function, numbers_only=operation in OPERATIONS)
    graded.reports.append(report_on(catalogue[operation], tried, function, student.forget))
    if student.printed():
        raise Fault(
            f"{function} prints {student.printed()!r}: an operation returns, it does not print"
        )
    if student.patched:
        raise Fault(f"{function} alters NumPy itself: {', '.join(student.patched[:5])}")
    if student.refused:
        raise Fault(f"refused: {function} imports {student.refused[0]}")
