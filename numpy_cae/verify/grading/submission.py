"""What a student hands in: a Python file, or a lesson's notebook with its exercise cells."""

import json
import re
import sys
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from warnings import catch_warnings

import numpy as np

from numpy_cae.verify.checks.call import error_text

LARGEST_PROGRAM = 2**20
"""LARGEST_PROGRAM: a Python file may have at most so many bytes."""
LARGEST_NOTEBOOK = 2**25
"""LARGEST_NOTEBOOK: a notebook, with its pictures, may have at most so many bytes."""
MAGIC = re.compile(r"^[%!].*$", re.MULTILINE)
CHECK = re.compile(r"^course\.report\(\s*[\"'](\w+)", re.MULTILINE)
STUB = re.compile(r"^ +raise NotImplementedError", re.MULTILINE)
Functions = Mapping[str, Callable]
DEFINITION = re.compile(r"^def (\w+)\(", re.MULTILINE)


@dataclass(frozen=True)
class Submission:
    """A student's file. `cells` are the parts that are run: the file, or the exercise cells.

    A cell is (name, text). `ids` are the names of all exercises in a notebook, `copied` those whose
    cell is there more than once; `fault` says why a file cannot be read.
    """

    path: Path
    cells: tuple[tuple[str, str | bytes], ...] = ()
    ids: frozenset[str] = frozenset()
    copied: tuple[str, ...] = ()
    fault: str = ""

    @property
    def is_notebook(self) -> bool:
        return self.path.suffix == ".ipynb"

    def lesson(self, lessons: Mapping[str, Collection[str]]) -> str:
        """The number of the lesson that the file belongs to, by its cells or its name, or ""."""
        shared = {number: len(self.ids & set(names)) for number, names in lessons.items()}
        if any(shared.values()):
            return max(shared, key=shared.__getitem__)
        number = self.path.name.partition("_")[0]
        return number if number in lessons else ""

    def defined(self) -> set[str]:
        """The names of functions in the text, even if the text is not valid Python."""
        return _defined(self._text())

    def calls(self, name: str) -> bool:
        """Whether the text seems to call a function, besides defining it."""
        calls = re.findall(rf"(?<![.\w]){name}\(", self._text())
        return len(calls) > (name in self.defined())

    def _text(self) -> str:
        sources = (source for _, source in self.cells)
        return "\n".join(s if isinstance(s, str) else s.decode("latin-1") for s in sources)

    def run(self, given: Functions, instead: Functions) -> tuple[dict[str, Callable], list[str]]:
        """Run it as a module; return the functions that it defines, and what went wrong.

        The parts may use the functions of `given` and, in a notebook, `np`. After the parts have
        run, the functions of `instead` replace those of the same names.
        """
        module = ModuleType("student")
        mine = ModuleType("mine")
        vars(mine).update(given)  # the functions of earlier lessons
        sys.modules.update(student=module, mine=mine)
        problems = []
        sys.path.append(str(self.path.parent))
        names = vars(module)
        builtins = vars(sys.modules["builtins"])
        names |= {"__file__": str(self.path), "__builtins__": builtins, **given}
        if self.is_notebook:
            names["np"] = sys.modules["numpy"]
        for name, source in self.cells:
            try:
                with np.errstate(), catch_warnings():
                    exec(compile(source, name, "exec"), names)
            except BaseException as error:  # such as SystemExit
                part = name if self.is_notebook else "at import"
                problems.append(f"{part}: {error_text(error, name)}")
        defined = list(names.items())
        names |= instead
        functions = {name: f for name, f in defined if callable(f) and f is not given.get(name)}
        return functions, problems


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
    is_notebook = Submission(path).is_notebook
    largest = LARGEST_NOTEBOOK if is_notebook else LARGEST_PROGRAM
    with path.open("rb") as file:
        content = file.read(largest + 1)
    if len(content) > largest:
        raise ValueError(f"it is larger than {largest // 2**20} MB")
    if not is_notebook:
        return Submission(path, ((str(path), content),))
    try:
        cells = json.loads(content.decode("utf-8-sig"))["cells"]
        marked = [_id(cell) for cell in cells if is_exercise(cell) and _id(cell)]
        ids = {_id(cell).removesuffix("_check") for cell in cells} - {""}
        ids |= {name for cell in cells for name in CHECK.findall(_source(cell))}
        sources = _answers(cells, ids)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"it is not a Jupyter notebook: {error}") from None
    if not sources:
        raise ValueError("it has no exercise cell: is it a copy of a lesson?")
    copied = tuple(sorted({name for name in marked if marked.count(name) > 1}))
    return Submission(path, tuple(sources), frozenset(ids), copied)


def _answers(cells: list[dict], ids: Collection[str]) -> list[tuple[str, str]]:
    """The cells with the exercises: those that are marked, except that a stub gives way to others.

    A stub is replaced by each cell that defines the same function, whether it is marked or not.
    """
    marked = [cell for cell in cells if is_exercise(cell)]
    stubs = [cell for cell in marked if STUB.search(_source(cell))]
    answered = {n for cell in marked if cell not in stubs for n in _defined(_source(cell))}
    sources = []
    for number, cell in enumerate((c for c in cells if c["cell_type"] == "code"), 1):
        defined = _defined(_source(cell)) & set(ids)
        if cell in stubs and defined and defined <= answered:
            continue
        if cell in marked or (defined and not defined & answered):
            sources.append((f"cell {_id(cell) or number}", _source(cell)))
    return sources


def is_exercise(cell: dict) -> bool:
    """Whether a cell is one that a student fills."""
    marks = cell["metadata"].get("nbgrader", {})
    return cell["cell_type"] == "code" and bool(marks.get("solution"))


def _defined(text: str) -> set[str]:
    return set(DEFINITION.findall(text))


def _id(cell: dict) -> str:
    return str(cell["metadata"].get("nbgrader", {}).get("grade_id", ""))


def _source(cell: dict) -> str:
    """The text of a cell without Jupyter's own commands."""
    return MAGIC.sub("pass", "".join(cell["source"]))
