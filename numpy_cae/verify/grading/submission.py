"""What a student hands in: a Python file, or a lesson's notebook with its exercise cells."""

import ast
import json
import re
from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SUFFIXES = (".py", ".ipynb")
"""What files that are graded end with."""
COPY = re.compile(r"(-Copy\d+|-\d+| ?\(\d+\))+$")
"""What Jupyter, Canvas and browsers add to the name of a file that exists."""
LARGEST_PROGRAM = 2**20
"""A Python file may have at most this many bytes."""
LARGEST_NOTEBOOK = 2**25
"""A notebook, with its pictures, may have at most this many bytes."""
MAGIC = re.compile(r"^[%!].*$|^get_ipython\(\)\..*$", re.MULTILINE)
"""Jupyter's own commands, in a notebook and in a script that Jupyter has made of it."""
CELL_MAGIC = re.compile(r"^get_ipython\(\)\.run_cell_magic\(.*\)$", re.MULTILINE)
"""A cell below a command such as %%time, in a script that Jupyter has made."""
EXPORTED_CELL = re.compile(r"^# (?:In ?\[[ \d]*\]:|%%.*)$", re.MULTILINE)
"""What stands above each cell in a script that Jupyter or VS Code has made of a notebook."""
CHECK = re.compile(r"^course\.report\(\s*[\"'](\w+)", re.MULTILINE)
STUB = re.compile(r"^ +raise NotImplementedError", re.MULTILINE)
DEFINITION = re.compile(r"^def (\w+)\(", re.MULTILINE)


@dataclass(frozen=True)
class Submission:
    """A student's file. `cells` are the parts that are run: the file, or the exercise cells.

    A cell is (name, text). `ids` are the names of all exercises in a notebook, `copied` those whose
    cell is there more than once; `fault` says why a file cannot be read. `is_export` is true for a
    script that was made of a notebook, which is read like the notebook.
    """

    path: Path
    cells: tuple[tuple[str, str | bytes], ...] = ()
    ids: frozenset[str] = frozenset()
    copied: tuple[str, ...] = ()
    fault: str = ""
    is_export: bool = False

    @property
    def is_notebook(self) -> bool:
        return self.is_export or self.path.suffix == ".ipynb"

    def lesson(self, lessons: Mapping[str, Collection[str]]) -> str:
        """The number of the lesson that the file belongs to, by its cells or its name, or ""."""
        shared = {number: len(self.ids & set(names)) for number, names in lessons.items()}
        if any(shared.values()):
            return max(shared, key=shared.__getitem__)
        return lesson_of_name(self.path.stem, lessons)

    def functions_defined(self) -> set[str]:
        """The names of functions in the text, even if the text is not valid Python."""
        return _names_defined(self._text())

    def calls(self, name: str) -> bool:
        """Whether the text seems to call a function, besides defining it."""
        calls = re.findall(rf"(?<![.\w]){name}\(", self._text())
        definitions = 1 if name in self.functions_defined() else 0
        return len(calls) > definitions

    def _text(self) -> str:
        texts = []
        for _, source in self.cells:
            texts.append(source if isinstance(source, str) else source.decode("latin-1"))
        return "\n".join(texts)


def lesson_of_name(stem: str, lessons: Collection[str]) -> str:
    """The lesson at the beginning or the end of a file's name, or ""."""
    parts = COPY.sub("", stem).split("_")
    for part in (parts[0], parts[-1]):
        if part in lessons:
            return part
    return ""


def read_submission(path: Path) -> Submission:
    """Read a Python file as it is; of an .ipynb file, the cells that nbgrader marks as solutions.

    An exercise whose marked cell is still the stub, or has lost its mark, is looked for in the
    other cells. A file that is too large, or no notebook with an exercise cell, has a fault.
    """
    try:
        if not path.is_file():
            raise ValueError("it is no file" if path.exists() else "there is no such file")
        return _read(path)
    except (ValueError, OSError) as error:
        return Submission(path, fault=str(error))


def _read(path: Path) -> Submission:
    """The file; raise a ValueError that says what is wrong with it."""
    is_notebook = Submission(path).is_notebook
    largest = LARGEST_NOTEBOOK if is_notebook else LARGEST_PROGRAM
    with path.open("rb") as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        raise ValueError(f"it is larger than {largest // 2**20} MB")
    if is_notebook:
        return _read_notebook(path, content)
    return _read_export(path, content) or Submission(path, ((str(path), content),))


def _read_export(path: Path, content: bytes) -> Submission | None:
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
    return Submission(path, tuple(_answers(cells, ids)), frozenset(ids), is_export=True)


def _cell_below_magic(call: re.Match[str]) -> str:
    """The text of a cell that is an argument of run_cell_magic; the call itself if it is none."""
    try:
        arguments = ast.parse(call[0]).body[0].value.args  # type: ignore[attr-defined]
        return str(ast.literal_eval(arguments[2]))
    except (SyntaxError, ValueError, AttributeError, IndexError):
        return call[0]


def _read_notebook(path: Path, content: bytes) -> Submission:
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
    return Submission(path, tuple(sources), frozenset(ids), copied)


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
            answered |= _names_defined(_source(cell))
    sources = []
    for number, cell in enumerate(code_cells, 1):
        defined = _names_defined(_source(cell)) & names
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


def _is_stub(cell: dict[str, Any]) -> bool:
    """Whether a cell has still the body with which a lesson begins."""
    return bool(STUB.search(_source(cell)))


def _names_defined(text: str) -> set[str]:
    """The names of the functions that a text defines."""
    return set(DEFINITION.findall(text))


def _id(cell: dict[str, Any]) -> str:
    """nbgrader's name of a cell, or ""."""
    return str(cell["metadata"].get("nbgrader", {}).get("grade_id", ""))


def _source(cell: dict[str, Any]) -> str:
    """The text of a cell without Jupyter's own commands."""
    return MAGIC.sub("pass", "".join(cell["source"]))
