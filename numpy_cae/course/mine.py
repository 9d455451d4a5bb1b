"""`mine.py` beside the notebooks: a student's solved functions, which later lessons import.

    from mine import conv1d, max_pool

imports the student's own where they are solved, and else the package's. It has to follow the import
of `numpy_cae.course`. Where there is no `mine.py`, or it cannot be run, all are the package's.
"""

from __future__ import annotations

import ast
import importlib.abc
import importlib.machinery
import inspect
import os
import re
import sys
import textwrap
import traceback
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from symtable import SymbolTable, symtable
from types import FunctionType, ModuleType

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.exercises import CATALOGUE
from numpy_cae.course.notebook import find_lessons, read_notebook
from numpy_cae.errors import NumpyCaeError
from numpy_cae.verify.submission import is_exercise

FILE = "mine.py"
EMPTY = '''"""My functions. course.solved() writes a function here when all its properties hold.

In a lesson, after importing numpy_cae.course:    from mine import conv1d
"""

import numpy as np
'''


class NotSavedError(NumpyCaeError):
    """A function that cannot be written to mine.py; the message says why."""


def stand_in(name: str) -> Callable:
    """The package's own function, marked, so that a check does not take it for the student's."""
    solution = CATALOGUE[name].solution

    @wraps(solution)
    def standing_in(*arguments, **named):
        return solution(*arguments, **named)

    standing_in.__name__ = name
    standing_in.stands_in = True
    return standing_in


def save(name: str, function: Callable) -> bool:
    """Write a function, and what it uses of the notebook, to the mine.py of the current folder.

    Returns False where there is no mine.py, or nbgrader runs the notebook.

    Raises
    ------
    NotSavedError
        If mine.py cannot be run, the source is not found, or it uses what cannot be written.
    """
    if not Path(FILE).is_file() or os.environ.get("NBGRADER_EXECUTION"):
        return False
    before = Path(FILE).read_text(encoding="utf-8")
    run(before)
    pieces = _pieces(function, {})
    if function.__name__ != name:
        pieces[name] = f"{name} = {function.__name__}"
    after = with_pieces(before, pieces)
    run(after)
    with atomic_write(FILE) as beside:
        beside.write_text(after, encoding="utf-8")
    sys.modules.pop("mine", None)  # the next import reads the file again
    return True


def mine_before(lesson: Path) -> str:
    """The text of mine.py with the solutions of all lessons before this one, in its folder."""
    text = EMPTY
    for path in find_lessons(lesson.parent):
        if path.name < lesson.name:
            cells = filter(is_exercise, read_notebook(path)["cells"])
            solved = {c["metadata"]["nbgrader"]["grade_id"]: c["source"] for c in cells}
            text = with_pieces(text, solved)
    return re.sub("^ +### .* SOLUTION\n", "", text, flags=re.M)


def with_pieces(text: str, pieces: dict[str, str]) -> str:
    """The text of mine.py with these definitions, by name, at its end instead of earlier ones."""
    lines = text.splitlines()
    pieces = {name: piece for name, piece in pieces.items() if piece not in lines}
    for node in reversed(ast.parse(text).body):
        if _bound(node) & pieces.keys() and not isinstance(node, ast.Import | ast.ImportFrom):
            first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))])
            del lines[first - 1 : node.end_lineno]
    kept = "\n".join(lines).rstrip()
    return "\n\n\n".join([kept, *(piece.strip() for piece in pieces.values())]) + "\n"


def run(text: str) -> dict[str, object]:
    """What the text of mine.py defines; NotSavedError names the line that cannot be run."""
    space = {name: stand_in(name) for name in CATALOGUE}
    space |= {"__name__": "mine", "__file__": FILE}
    try:
        code = compile(text, FILE, "exec")
    except SyntaxError as error:
        raise NotSavedError(f"{FILE}, line {error.lineno}: {error.msg}") from None
    except ValueError as error:
        raise NotSavedError(f"{FILE}: {error}") from None
    try:
        exec(code, space)
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        line = [frame.lineno for frame in frames if frame.filename == FILE][-1]
        raise NotSavedError(f"{FILE}, line {line}: {type(error).__name__}: {error}") from None
    return {name: v for name, v in space.items() if not hasattr(v, "stands_in")}


class _Finder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Imports `mine`; a file that cannot be run is reported, and the package's own are used."""

    def find_spec(self, name, path=None, target=None):
        return importlib.machinery.ModuleSpec(name, self) if name == "mine" else None

    def exec_module(self, module: ModuleType) -> None:
        usable = False
        if os.environ.get("NBGRADER_EXECUTION"):
            pass  # marks do not depend on earlier lessons
        elif not Path(FILE).is_file():
            print(f"There is no {FILE} in this folder: the package's own functions are used.")
        else:
            try:
                vars(module).update(run(Path(FILE).read_text(encoding="utf-8")))
                usable = True
            except (NotSavedError, UnicodeDecodeError) as error:
                print(f"{error}\nUntil this is repaired, the package's own functions are used.")

        def package_own(name: str) -> Callable:
            if name not in CATALOGUE:
                raise AttributeError(f"no operation or exercise is called {name!r}")
            if usable:
                print(f"{name} is not in {FILE} yet: the package's own is used.")
            return stand_in(name)

        module.__getattr__ = package_own


def _pieces(function: Callable, found: dict[str, str]) -> dict[str, str]:
    """The source of a function by its name, after that of what it uses."""
    own = function.__name__
    try:
        source = textwrap.dedent(inspect.getsource(function))
        (node,) = ast.parse(source).body
    except (OSError, TypeError, SyntaxError, ValueError):
        raise NotSavedError(f"the source of {own} was not found") from None
    if own not in _bound(node) or function.__closure__:
        raise NotSavedError(f"{own} is not defined by a def of its own")
    found[own] = ""  # a function may call itself
    space = function.__globals__
    for name in sorted(_globals(symtable(source, own, "exec")) & space.keys() - {own}):
        value = space[name]
        if name in CATALOGUE or name in found:
            continue
        if isinstance(value, FunctionType) and value.__module__ == function.__module__:
            _pieces(value, found)
        else:
            found[name] = _statement(name, value, own)
    del found[own]
    found[own] = source
    return found


def _statement(name: str, value: object, user: str) -> str:
    """The statement that binds a name to a module, to something of a module, or to a number."""
    if isinstance(value, ModuleType):
        return f"import {value.__name__}" + (f" as {name}" if name != value.__name__ else "")
    module, there = getattr(value, "__module__", ""), getattr(value, "__name__", "")
    if module and getattr(sys.modules.get(module), there, None) is value and module != "__main__":
        return f"from {module} import {there}" + (f" as {name}" if name != there else "")
    try:
        if ast.literal_eval(repr(value)) == value:
            return f"{name} = {value!r}"
    except (ValueError, SyntaxError):
        pass
    raise NotSavedError(f"{user} uses {name}, which only this notebook has: make it an argument")


def _bound(node: ast.stmt) -> set[str]:
    """The names that a statement at the top of a file defines."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    if isinstance(node, ast.Import | ast.ImportFrom):
        return {alias.asname or alias.name for alias in node.names}
    if isinstance(node, ast.Assign):
        return {target.id for target in node.targets if isinstance(target, ast.Name)}
    return set()


def _globals(table: SymbolTable) -> set[str]:
    """The global names that a source refers to, in its functions too."""
    own = {s.get_name() for s in table.get_symbols() if s.is_global() and s.is_referenced()}
    return own.union(*map(_globals, table.get_children()))


sys.meta_path.insert(0, _Finder())
