"""The file `mine.py`, in the folder of the notebooks: a student's solved functions.

    course.load_mine()
    from mine import conv1d, max_pool

The first line runs the file and makes the module `mine` of it. The second line imports the
student's functions; for those that `mine.py` lacks, it imports the package's own.
"""

import ast
import dis
import linecache
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import CodeType, ModuleType

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.catalogue import CATALOGUE, EXERCISES
from numpy_cae.course.stand_in import is_stand_in, stand_in
from numpy_cae.course.submitted_file import MAGIC
from numpy_cae.errors import NumpyCaeError
from numpy_cae.verify.checks.messages import error_text, file_of
from numpy_cae.verify.operations.counterexample import failure

FILE = "mine.py"
EMPTY = '''"""My functions. course.solved() writes a function here when all its properties hold.

In a lesson, after course.load_mine():    from mine import conv1d
"""

import numpy as np
'''


class NotSavedError(NumpyCaeError):
    """A function that cannot be written to mine.py; the message says why."""


def nbgrader_runs() -> bool:
    """Whether nbgrader runs the notebook."""
    return bool(os.environ.get("NBGRADER_EXECUTION"))


def read_mine() -> str:
    """The text of mine.py; a FileNotFoundError if the folder has none."""
    return Path(FILE).read_text(encoding="utf-8")


def run_mine(text: str) -> dict[str, object]:
    """What the text of mine.py defines; a NotSavedError names a line that cannot be run."""
    space: dict[str, object] = {name: stand_in(name) for name in CATALOGUE}
    space["__name__"] = "mine"
    space["__file__"] = FILE
    try:
        exec(compile(text, FILE, "exec"), space)
    except Exception as error:
        raise NotSavedError(f"{FILE} cannot be run: {error_text(error, FILE)}") from None
    return {name: value for name, value in space.items() if not is_stand_in(value)}


def load_mine() -> None:
    """Make the module `mine` of the file mine.py in the current folder.

    All functions are the package's own if there is no mine.py, if mine.py cannot be run, or while
    nbgrader runs the notebook, since marks do not depend on earlier lessons. In the first two cases
    this is printed. The name of a function that is imported and not in mine.py is printed, too.
    """
    module = ModuleType("mine")
    is_loaded = False
    if not nbgrader_runs():
        try:
            vars(module).update(run_mine(read_mine()))
            is_loaded = True
        except FileNotFoundError:
            print(f"There is no {FILE} in this folder: the package's own functions are used.")
        except (NotSavedError, UnicodeDecodeError) as error:
            print(f"{error}\nUntil this is repaired, the package's own functions are used.")

    def package_own(name: str) -> Callable:
        if name not in CATALOGUE:
            raise AttributeError(f"no operation or exercise is called {name!r}")
        if is_loaded:
            print(f"{name} is not in {FILE} yet: the package's own is used.")
        return stand_in(name)

    vars(module)["__getattr__"] = package_own  # called for a name that the module lacks
    sys.modules["mine"] = module


def save(name: str, function: Callable) -> bool:
    """Write a function, with all that its cell defines, to the mine.py of the current folder.

    Returns False if there is no mine.py, or while nbgrader runs the notebook. Raises a
    NotSavedError if mine.py cannot be run, or if the function needs more than its cell defines.
    """
    if not Path(FILE).is_file() or nbgrader_runs():
        return False
    before = read_mine()
    run_mine(before)
    cell = "".join(linecache.getlines(file_of(function)))  # IPython has a file name for each cell
    after = with_definitions(before, MAGIC.sub("pass", cell))
    saved = run_mine(after).get(name)
    if not callable(saved):
        raise NotSavedError(f"no def {name} was found")
    _require_complete(name, saved)
    with atomic_write(FILE) as temporary:
        temporary.write_text(after, encoding="utf-8")
    if "mine" in sys.modules:
        load_mine()
    return True


def _require_complete(name: str, saved: Callable) -> None:
    """Raise a NotSavedError unless a function of mine.py works as it did in its notebook."""
    for property_ in EXERCISES[name].properties:
        error = failure(property_, saved, property_.cases()[0])
        if error is not None:
            problem = str(error) if isinstance(error, AssertionError) else error_text(error)
            raise NotSavedError(f"{problem}. Define what it needs in its own cell")


def with_definitions(text: str, cell: str) -> str:
    """The text of mine.py with the definitions of a cell at the end, which replace older ones."""
    lines = text.splitlines()
    statements = ast.parse(text).body
    imports = {ast.unparse(statement) for statement in statements if _is_import(statement)}
    added = []
    names: set[str] = set()
    for statement in definitions_of(ast.parse(cell)).body:
        if ast.unparse(statement) not in imports:
            added.append(statement)
            names |= _names(statement)
    for statement in reversed(statements):
        if _names(statement) & names:
            del lines[_first_line(statement) - 1 : statement.end_lineno]
    blocks = ["\n".join(lines).rstrip()]
    for statement in added:
        source = cell.splitlines()[_first_line(statement) - 1 : statement.end_lineno]
        blocks.append("\n".join(source))
    return "\n\n\n".join(blocks) + "\n"


def definitions_of(tree: ast.Module, name: str = "") -> ast.Module:
    """The statements of a cell that mine.py takes.

    These are imports, functions, classes, constants, and what functions and classes need of the
    other assignments. A name that is given is needed, too.
    """
    needed = {name}
    for statement in tree.body:
        if isinstance(statement, ast.FunctionDef | ast.ClassDef):
            needed |= _global_names(statement)
    for statement in reversed(tree.body):
        if _names(statement) & needed:
            needed |= _global_names(statement)
    statements: list[ast.stmt] = []
    for statement in tree.body:
        is_needed = bool(_names(statement) & needed)
        if is_needed or _is_definition(statement):
            statements.append(statement)
    return ast.Module(statements, type_ignores=[])


def _is_definition(statement: ast.stmt) -> bool:
    """Whether mine.py takes a statement wherever it is used."""
    if _is_import(statement):
        return not _imports_mine(statement)
    if isinstance(statement, ast.Assign) and not _is_constant(statement.value):
        return False
    return bool(_names(statement))


def _global_names(statement: ast.stmt) -> set[str]:
    """The global names that a statement, and the functions in it, use."""
    code = compile(ast.Module([statement], type_ignores=[]), FILE, "exec")
    return set(global_names(code))


def global_names(code: CodeType) -> Iterator[str]:
    """The global names that a piece of code, and the functions in it, use."""
    for instruction in dis.get_instructions(code):
        if instruction.opname in ("LOAD_GLOBAL", "LOAD_NAME"):
            yield str(instruction.argval)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from global_names(constant)


def _is_import(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Import | ast.ImportFrom)


def _imports_mine(statement: ast.stmt) -> bool:
    """Whether a statement imports functions of earlier lessons, which mine.py has."""
    return isinstance(statement, ast.ImportFrom) and statement.module == "mine"


def _names(statement: ast.stmt) -> set[str]:
    """The names that a function, a class or an assignment defines; of others, none."""
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return {statement.name}
    if isinstance(statement, ast.Assign):
        return _target_names(statement.targets)
    return set()


def _is_constant(value: ast.expr) -> bool:
    try:
        ast.literal_eval(value)
    except (ValueError, TypeError):
        return False
    return True


def _target_names(targets: Iterable[ast.expr]) -> set[str]:
    """The names that an assignment sets; none if it sets anything else, too."""
    names = set()
    for target in targets:
        if not isinstance(target, ast.Name):
            return set()
        names.add(target.id)
    return names


def _first_line(statement: ast.stmt) -> int:
    """The line in which a statement begins, with its decorators."""
    decorators = getattr(statement, "decorator_list", ())
    return min([statement.lineno, *(decorator.lineno for decorator in decorators)])
