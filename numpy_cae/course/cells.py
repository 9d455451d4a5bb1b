"""What the cells of a notebook call: reports on a student's functions, and `mine.py`.

`mine.py`, in the folder of the notebooks, has a student's solved functions, for later lessons.

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
from contextlib import redirect_stderr, redirect_stdout, suppress
from dataclasses import replace
from functools import wraps
from inspect import signature
from pathlib import Path
from types import ModuleType

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.catalogue import CATALOGUE, EXERCISES, LESSONS
from numpy_cae.course.exercises.exercise import MAKES, with_hint
from numpy_cae.course.feedback import Feedback, Printed
from numpy_cae.errors import NumpyCaeError
from numpy_cae.verify.checks.call import error_text, file_of
from numpy_cae.verify.grading.report import holds
from numpy_cae.verify.grading.report import report as report_on
from numpy_cae.verify.grading.submission import MAGIC
from numpy_cae.verify.operations.catalogue import example as example_of
from numpy_cae.verify.operations.catalogue import find_exercise
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


def report(name: str, function: Callable, hint: int = 0) -> Feedback | int:
    """Test a student's function for every property of an operation or an exercise.

    While nbgrader runs the notebook, the report is printed and its points are returned, because
    nbgrader takes a number that a check cell returns as the points of the exercise. The points are
    those of `numpy-cae verify`.

    In a notebook the report is shown where it is the last line of a cell; in a script nothing is
    shown: `print(course.report(name, function))`.

    Of what the function prints in the tests, the first lines are shown above the report. Where
    `solved` replaced the function by the package's own, the one that it replaced is tested.

    After a first attempt, `hint=1` adds a hint to the report and `hint=2` a second one. Raises a
    ValueError if there is no such operation or exercise, or no such hint.
    """
    exercise = find_exercise(name, CATALOGUE)
    called = None
    if hasattr(function, "stands_in"):
        called = name
        function = function.tried
        if function is unsolved:
            print(f"{name} is the package's own now: run the cell with your function again first")
    if os.environ.get("NBGRADER_EXECUTION"):
        with redirect_stdout(Printed()), redirect_stderr(Printed()):  # it would give 0 points
            tested = report_on(exercise, function, called=called)
        print(tested)
        return tested.points
    with redirect_stdout(Printed()) as printed:
        tested = report_on(with_hint(exercise, hint), function, called=called)
    print(printed, end="")
    if tested.unsolved:
        later = "a hint is shown after your first attempt" if hint else ""
        tested = replace(tested, exercise=replace(tested.exercise, hint=later))
    return Feedback(tested.exercise, tested.called, tested.outcomes)


def solved(name: str, function: Callable) -> Callable:
    """The function for later cells: the student's if every property holds, else the package's own.

    If the folder of the notebook has a file mine.py, the student's function is saved to it for
    later lessons. Prints what is done; raises a ValueError if there is no such exercise.
    """
    if name not in EXERCISES:
        raise ValueError(f"no exercise is called {name!r}; there are {', '.join(EXERCISES)}")
    with redirect_stdout(Printed()):
        is_right = not hasattr(function, "stands_in") and holds(EXERCISES[name], function)
    if not is_right:
        again = "run this cell again when yours is right"
        print(f"{name}: the next cells use the package's own; {again}")
        return function if hasattr(function, "stands_in") else stand_in(name, function)
    try:
        with redirect_stdout(Printed()):  # the cell is run again
            where = f" and later lessons ({FILE})" if save(name, function) else ""
        print(f"{name}: the next cells{where} use your function")
    except NotSavedError as error:
        print(f"{name}: the next cells use your function. It is not saved to {FILE}: {error}")
    return function


def example(name: str, seed: int, **sizes: int) -> dict[str, object]:
    """The arguments of a counterexample by name, for the call that a report prints.

    Raises a ValueError if there is no such operation or exercise, or a size is missing.
    """
    return example_of(find_exercise(name, CATALOGUE), seed, **sizes).arguments


def progress() -> None:
    """Print how many functions mine.py has, what the finished lessons make, and what is next."""
    mine: set[str] = set()
    with suppress(FileNotFoundError, NotSavedError, UnicodeDecodeError):
        mine = set(run_mine(Path(FILE).read_text(encoding="utf-8"))) & set(EXERCISES)
    missing = {n: {task.name for task in tasks} - mine for n, tasks in LESSONS.items()}
    made = [MAKES[number] for number, names in missing.items() if not names]
    print(f"{len(mine)} of {len(EXERCISES)} functions are yours")
    if made:
        print(f"They add up to: {', '.join(made)}.")
    if after := next((number for number, names in missing.items() if names), None):
        print(f"Next: {MAKES[after]} (lesson {after}).")


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
    run_mine(before)
    cell = "".join(linecache.getlines(file_of(function)))  # IPython has a file name for each cell
    after = with_definitions(before, MAGIC.sub("pass", cell))
    saved = run_mine(after).get(name)
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
            vars(module).update(run_mine(Path(FILE).read_text(encoding="utf-8")))
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


def run_mine(text: str) -> dict[str, object]:
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
