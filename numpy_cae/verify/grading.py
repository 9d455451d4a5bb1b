"""Grading of a student's file: every function in it is tested for its properties."""

from __future__ import annotations

import ast
import tempfile
import textwrap
import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from numpy_cae.errors import NumpyCaeError
from numpy_cae.verify.catalogue import CATALOGUE as OPERATIONS
from numpy_cae.verify.catalogue import Catalogue, find_task, load_catalogue
from numpy_cae.verify.notebook import NotebookError, exercise_source
from numpy_cae.verify.reporting import WIDTH, Report, failed_report, report_from_reply, visible
from numpy_cae.verify.sandbox.process import ProcessEnded, StudentProcess
from numpy_cae.verify.sandbox.refusal import refused_imports

TIME_LIMIT = 120.0
MEMORY_LIMIT = 2048


class Fault(NumpyCaeError):
    """A whole file cannot be graded."""


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
    """Run a student's file in a process of its own and test its functions.

    Parameters
    ----------
    path : Path
        A Python file, whose functions with the name of an operation are tested; or a lesson's
        notebook, whose exercise cells are tested.
    catalogue : str
        The module whose `CATALOGUE` lists what is tested.
    named : mapping of operation to function name, optional
        Functions with other names.
    seconds, megabytes : number
        Limits of the whole file. The memory limit is enforced on Linux.

    Returns
    -------
    FileReport
        Whatever the file does.

    Raises
    ------
    OSError
        If there is no such file.
    ValueError
        If `named` has a name that the catalogue lacks.
    """
    known = load_catalogue(catalogue)
    named = dict(named or {})
    for operation in named:
        find_task(known, operation)
    graded = FileReport(path)
    content = path.read_bytes()
    request = {"catalogue": catalogue, "megabytes": megabytes}
    deadline = time.monotonic() + seconds
    try:
        if path.suffix != ".ipynb":
            _require_allowed(content)
            request |= {"path": str(path.resolve()), "given": []}
            _grade_program(graded, known, OPERATIONS, named, request, deadline)
            return graded
        program = exercise_source(content)
        _require_allowed(program.encode())
        with tempfile.TemporaryDirectory() as folder:
            cells = Path(folder, "notebook.py")
            cells.write_text(program, encoding="utf-8")
            request |= {"path": str(cells), "given": _given(program, known)}
            _grade_program(graded, known, known, named, request, deadline)
    except (Fault, NotebookError) as fault:
        graded.faults.append(str(fault))
    return graded


def _given(program: str, catalogue: Catalogue) -> list[str]:
    """What the exercises in a program may call of earlier lessons, without its own definitions."""
    defined = {node.name for node in ast.parse(program).body if hasattr(node, "name")}
    wanted = {name for own in defined & set(catalogue) for name in catalogue[own].given}
    return sorted(wanted - defined)


def _require_allowed(content: bytes) -> None:
    """Raise a Fault if a file is not Python or imports what is refused."""
    try:
        refused = refused_imports(content.decode())
    except (SyntaxError, ValueError, RecursionError) as error:
        raise Fault(f"it is not Python: {error}") from None
    if refused:
        raise Fault(
            "refused: the operations are to be written by hand in NumPy, and it imports "
            f'{"; ".join(refused)} (self-tests may, under if __name__ == "__main__":)'
        )


def _grade_program(
    graded: FileReport,
    catalogue: Catalogue,
    known: Iterable[str],
    named: dict[str, str],
    request: dict,
    deadline: float,
) -> None:
    """Test a program's functions; a process that has to be ended is followed by another."""
    todo = list(({name: name for name in known} | named).items())
    with StudentProcess({**request, "tasks": todo}, deadline) as process:
        todo = _found(process, todo)
        for operation, function in named.items():
            if (operation, function) not in todo:
                raise Fault(f"it has no function {function} to try as {operation}")
        if not todo:
            raise Fault(
                f"no function has an operation's name ({', '.join(OPERATIONS)}); "
                "name one with --as conv1d=my_conv"
            )
        todo = _test(graded, catalogue, process, todo)
    while todo:
        with StudentProcess({**request, "tasks": todo}, deadline) as process:
            try:
                _found(process, todo)
            except Fault as fault:
                task, function = todo.pop(0)
                graded.reports.append(failed_report(catalogue[task], function, str(fault)))
                continue
            todo = _test(graded, catalogue, process, todo)


def _found(process: StudentProcess, todo: list[tuple[str, str]]) -> list[tuple[str, str]]:
    """The tasks whose functions a file has, once it is loaded."""
    try:
        reply = process.reply()
    except ProcessEnded as end:
        raise Fault(f"at import: {end}") from None
    if "fault" in reply:
        raise Fault(visible(str(reply["fault"])))
    return [pair for pair in todo if list(pair) in reply.get("found", [])]


def _test(
    graded: FileReport,
    catalogue: Catalogue,
    process: StudentProcess,
    todo: list[tuple[str, str]],
) -> list[tuple[str, str]]:
    """Test functions in one process until it ends; return those that are left."""
    while todo:
        task, function = todo.pop(0)
        try:
            reply = process.reply()["report"]
            if "ended" in reply:
                raise ProcessEnded(visible(str(reply["ended"])))
            report = report_from_reply(catalogue[task], function, reply)
        except (ProcessEnded, ValueError, KeyError, TypeError) as end:
            graded.reports.append(failed_report(catalogue[task], function, str(end)))
            return todo
        graded.reports.append(report)
    return []
