"""What a student hands in for a lesson: a notebook, a script made of one, or a Python file.

Of a notebook the exercise cells are run. They are those that nbgrader marks as solutions; one that
is still the stub, or has lost its mark, is looked for in the other cells.
"""

import ast
import json
import re
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from numpy_cae.verify.grading.submission import (
    LARGEST_PROGRAM,
    Submission,
    names_defined,
    read_bytes,
)

LARGEST_NOTEBOOK = 2**25
"""A notebook, with its pictures, may have at most this many bytes."""

Lessons = Mapping[str, Collection[str]]
"""The names of the exercises of each lesson, by its number."""


def read_for_lesson(path: Path, lessons: Lessons) -> Submission:
    """Read a file; one that is too large, or no notebook with an exercise cell, has a fault."""
    lesson = lesson_of_name(path.stem, lessons)
    is_notebook = path.suffix == ".ipynb"
    try:
        if is_notebook:
            return _read_notebook(path, read_bytes(path, LARGEST_NOTEBOOK), lessons)
        content = read_bytes(path, LARGEST_PROGRAM)
    except (ValueError, OSError) as error:
        return Submission(path, is_notebook=is_notebook, lesson=lesson, fault=str(error))
    program = Submission(path, ((str(path), content),), lesson=lesson)
    return _read_export(path, content, lessons) or program


COPY = re.compile(r"(-Copy\d+|-\d+| ?\(\d+\))+$")
"""What Jupyter, Canvas and browsers add to the name of a file that exists."""


def lesson_of_name(stem: str, lessons: Collection[str]) -> str:
    """The lesson at the beginning or the end of a file's name, or ""."""
    parts = COPY.sub("", stem).split("_")
    for part in (parts[0], parts[-1]):
        if part in lessons:
            return part
    return ""


def _lesson_of_exercises(ids: Collection[str], path: Path, lessons: Lessons) -> str:
    """The lesson with most of these exercises, or that of the file's name, or ""."""
    shared = {number: len(set(ids) & set(names)) for number, names in lessons.items()}
    if any(shared.values()):
        return max(shared, key=shared.__getitem__)
    return lesson_of_name(path.stem, lessons)


CELL_MAGIC = re.compile(r"^get_ipython\(\)\.run_cell_magic\(.*\)$", re.MULTILINE)
"""A cell below a command such as %%time, in a script that Jupyter has made."""
EXPORTED_CELL = re.compile(r"^# (?:In ?\[[ \d]*\]:|%%.*)$", re.MULTILINE)
"""What stands above each cell in a script that Jupyter or VS Code has made of a notebook."""
CHECK = re.compile(r"^course\.report\(\s*[\"'](\w+)", re.MULTILINE)


def _read_export(path: Path, content: bytes, lessons: Lessons) -> Submission | None:
    """The exercise cells of a script that Jupyter has made of a lesson; None for other files."""
    text = content.decode("utf-8-sig", "replace").replace("\r\n", "\n")
    parts = EXPORTED_CELL.split(text)
    if len(parts) == 1 or not CHECK.search(text):
        return None
    cells = []
    for part in parts[1:]:
        source = CELL_MAGIC.sub(_cell_below_magic, part)
        cells.append({"cell_type": "code", "metadata": {}, "source": source})
    ids = _names_of_exercises(cells)
    lesson = _lesson_of_exercises(ids, path, lessons)
    return Submission(path, tuple(_answers(cells, ids)), is_notebook=True, lesson=lesson)


COPIED = "the cell of {} is there more than once: the last one counts"


def _read_notebook(path: Path, content: bytes, lessons: Lessons) -> Submission:
    """The exercise cells of a notebook."""
    try:
        cells = json.loads(content.decode("utf-8-sig"))["cells"]
        marked = [_id(cell) for cell in cells if is_exercise(cell) and _id(cell)]
        ids = _names_of_exercises(cells)
        sources = _answers(cells, ids)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"it is not a Jupyter notebook: {error}") from None
    if not sources:
        raise ValueError("it has no exercise cell: is it a copy of a lesson?")
    copied = tuple(sorted(name for name, count in Counter(marked).items() if count > 1))
    lesson = _lesson_of_exercises(ids, path, lessons)
    submission = Submission(path, tuple(sources), is_notebook=True, lesson=lesson)
    return replace(submission, copied=copied, notes=tuple(map(COPIED.format, copied)))


def _cell_below_magic(call: re.Match[str]) -> str:
    """The text of a cell that is an argument of run_cell_magic; the call itself if it is none."""
    try:
        arguments = ast.parse(call[0]).body[0].value.args  # type: ignore[attr-defined]
        return str(ast.literal_eval(arguments[2]))
    except (SyntaxError, ValueError, AttributeError, IndexError):
        return call[0]


def _names_of_exercises(cells: list[dict[str, Any]]) -> set[str]:
    """The names of the exercises by the marks of their cells, and by the calls that check them."""
    names = {_id(cell).removesuffix("_check") for cell in cells} - {""}
    for cell in cells:
        names.update(CHECK.findall(_source(cell)))
    return names


def _answers(cells: list[dict[str, Any]], ids: Collection[str]) -> list[tuple[str, str]]:
    """The cells with the exercises: those that are marked, except that a stub gives way to others.

    A stub is replaced by each cell that defines the same function, whether it is marked or not.
    """
    names = set(ids)
    code_cells = [cell for cell in cells if cell["cell_type"] == "code"]
    answered: set[str] = set()
    for cell in code_cells:
        if is_exercise(cell) and not _is_stub(cell):
            answered |= names_defined(_source(cell))
    sources = []
    for number, cell in enumerate(code_cells, 1):
        defined = names_defined(_source(cell)) & names
        is_answered = bool(defined & answered)
        if is_exercise(cell) and _is_stub(cell) and defined and defined <= answered:
            continue
        if is_exercise(cell) or (defined and not is_answered):
            sources.append((f"cell {_id(cell) or number}", _source(cell)))
    return sources


def is_exercise(cell: dict[str, Any]) -> bool:
    """Whether a cell is one that a student fills."""
    marks = cell["metadata"].get("nbgrader", {})
    return cell["cell_type"] == "code" and bool(marks.get("solution"))


STUB = re.compile(r"^ +raise NotImplementedError", re.MULTILINE)


def _is_stub(cell: dict[str, Any]) -> bool:
    """Whether a cell has still the body with which a lesson begins."""
    return bool(STUB.search(_source(cell)))


def _id(cell: dict[str, Any]) -> str:
    """nbgrader's name of a cell, or ""."""
    return str(cell["metadata"].get("nbgrader", {}).get("grade_id", ""))


MAGIC = re.compile(r"^[%!].*$|^get_ipython\(\)\..*$", re.MULTILINE)
"""Jupyter's own commands, in a notebook and in a script that Jupyter has made of it."""


def _source(cell: dict[str, Any]) -> str:
    """The text of a cell without Jupyter's own commands."""
    return MAGIC.sub("pass", "".join(cell["source"]))
