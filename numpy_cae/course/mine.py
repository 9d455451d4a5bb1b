"""`mine.py`, in the folder of the notebooks: a student's solved functions, for later lessons.

    course.load_mine()
    from mine import conv1d, max_pool

The first line runs the file `mine.py` and makes the module `mine` of it. The second line imports
the student's functions; for those that `mine.py` lacks, it imports the package's own.
"""

import ast
import linecache
import os
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from inspect import signature
from pathlib import Path
from types import ModuleType

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.catalogue import CATALOGUE, EXERCISES
from numpy_cae.errors import NumpyCaeError
from numpy_cae.verify.checks.mismatch import error_text, file_of
from numpy_cae.verify.grading.submission import MAGIC
from numpy_cae.verify.operations.trial import try_property

FILE = "mine.py"
IMPORTS = (ast.Import, ast.ImportFrom)
EMPTY = '''"""My functions. course.solved() writes a function here when all its properties hold.

In a lesson, after course.load_mine():    from mine import conv1d
"""

import numpy as np
'''


class NotSavedError(NumpyCaeError):
    """A function that cannot be written to mine.py; the message says why."""


def unsolved(*arguments):
    """What is tested in place of a function that a student has not written."""
    raise NotImplementedError


def stand_in(name: str, tried: Callable = unsolved) -> Callable:
    """The package's own function, with a mark by which a check tells it from the student's.

    `tried` is the student's last one: `course.report` shows hints for it.
    """
    solution = CATALOGUE[name].solution

    @wraps(solution)
    def standing_in(*arguments, **named):
        return solution(*arguments, **named)

    del standing_in.__wrapped__  # `name??` in a notebook would show the solution
    standing_in.__signature__ = signature(solution)
    standing_in.__name__ = name
    standing_in.stands_in = True
    standing_in.tried = tried
    return standing_in


def save(name: str, function: Callable) -> bool:
    """Write a function, with all that its cell defines, to the mine.py of the current folder.

    Returns False if there is no mine.py, or while nbgrader runs the notebook. Raises a
    NotSavedError if mine.py cannot be run, or if the function needs more than its cell defines.
    """
    if not Path(FILE).is_file() or os.environ.get("NBGRADER_EXECUTION"):
        return False
    before = Path(FILE).read_text(encoding="utf-8")
    run(before)
    cell = "".join(linecache.getlines(file_of(function)))  # IPython has a file name for each cell
    after = with_definitions(before, MAGIC.sub("pass", cell))
    saved = run(after).get(name)
    if saved is None:
        raise NotSavedError(f"no def {name} was found")
    first = replace(EXERCISES[name].properties[0], examples=1)
    outcome = try_property(first, saved, shrink=False)
    if not outcome.held:
        problem, _, _ = outcome.problem.partition(" (line")
        raise NotSavedError(f"{problem}. Define what it needs in its own cell")
    with atomic_write(FILE) as temporary:
        temporary.write_text(after, encoding="utf-8")
    if "mine" in sys.modules:
        load_mine()
    return True


def load_mine() -> None:
    """Make the module `mine` of the file mine.py in the current folder.

    All functions are the package's own if there is no mine.py, if mine.py cannot be run, or while
    nbgrader runs the notebook, since marks do not depend on earlier lessons. In the first two cases
    this is printed. The name of a function that is imported and not in mine.py is printed, too.
    """
    module = ModuleType("mine")
    usable = False
    if not os.environ.get("NBGRADER_EXECUTION"):
        try:
            vars(module).update(run(Path(FILE).read_text(encoding="utf-8")))
            usable = True
        except FileNotFoundError:
            print(f"There is no {FILE} in this folder: the package's own functions are used.")
        except (NotSavedError, UnicodeDecodeError) as error:
            print(f"{error}\nUntil this is repaired, the package's own functions are used.")

    def package_own(name: str) -> Callable:
        if name not in CATALOGUE:
            raise AttributeError(f"no operation or exercise is called {name!r}")
        if usable:
            print(f"{name} is not in {FILE} yet: the package's own is used.")
        return stand_in(name)

    module.__getattr__ = package_own  # called for a name that the module lacks
    sys.modules["mine"] = module


def with_definitions(text: str, cell: str) -> str:
    """The text of mine.py with the definitions of a cell at the end, which replace older ones."""
    lines = text.splitlines()
    statements = ast.parse(text).body
    imported = {ast.unparse(node) for node in statements if isinstance(node, IMPORTS)}
    lessons = {ast.unparse(n) for n in ast.parse(cell).body if getattr(n, "module", "") == "mine"}
    added = [n for n in ast.parse(cell).body if ast.unparse(n) not in imported | lessons]
    names = set().union(*map(_names, added))
    for node in reversed(statements):
        if _names(node) & names:
            del lines[_first(node) - 1 : node.end_lineno]
    sources = [_source(n, cell) for n in added if isinstance(n, IMPORTS) or _names(n)]
    kept = "\n".join(lines).rstrip()
    return "\n\n\n".join([kept, *sources]) + "\n"


def run(text: str) -> dict[str, object]:
    """What the text of mine.py defines; a NotSavedError names a line that cannot be run."""
    space = {name: stand_in(name) for name in CATALOGUE}
    space |= {"__name__": "mine", "__file__": FILE}
    try:
        exec(compile(text, FILE, "exec"), space)
    except Exception as error:
        raise NotSavedError(f"{FILE} cannot be run: {error_text(error, FILE)}") from None
    return {name: v for name, v in space.items() if not hasattr(v, "stands_in")}


def _names(node: ast.stmt) -> set[str]:
    """The names of a function, a class or constants; of any other statement, none."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    if isinstance(node, ast.Assign) and all(isinstance(t, ast.Name) for t in node.targets):
        try:
            ast.literal_eval(node.value)
        except (ValueError, TypeError):
            return set()
        return {target.id for target in node.targets}
    return set()


def _first(node: ast.stmt) -> int:
    return min([node.lineno, *(each.lineno for each in getattr(node, "decorator_list", ()))])


def _source(node: ast.stmt, text: str) -> str:
    return "\n".join(text.splitlines()[_first(node) - 1 : node.end_lineno])
