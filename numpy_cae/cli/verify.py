"""Test the functions of a Python file that have the name of an operation of numpy_cae.ops (conv1d,
gru, ...) for every property of that operation. Print for each property whether it holds, the
smallest counterexample, and the likely mistake if the function behaves as a known wrong one does.
In a lesson's notebook (.ipynb), test the functions in the exercise cells.

example: numpy-cae verify student.py --as conv1d=my_conv

The points possible are those of all exercises of a lesson: the one that --lesson
names, or that a notebook's cells or a name such as 03_mine.py tell. A file of no
lesson is graded for the functions that it has.

Each function runs in a process of its own with limits on time, memory, files and
processes; where bubblewrap (bwrap) is installed and works, also without network
and without write access. This protects against mistakes and shortcuts, not against
an attack: a file can read what its user can, the solutions in the source of
numpy_cae among it, and find the tests in the memory of its process. On Windows an
endless loop ends the grading of the whole file. Grade files of people you do not
trust in a container, and not as root. Exit status: 0 if every property holds, 1 if
something fails, 2 if there was nothing to grade.
"""

import argparse
import re
from pathlib import Path
from typing import Any

from numpy_cae.cli import arguments as kinds


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the names of functions and the limits."""
    add = parser.add_argument
    files = "a Python file, a lesson's notebook, or a folder of these"
    add("files", **kinds.FILE, nargs="+", help=files)
    named: dict[str, Any] = {"dest": "named", "type": _named, "action": "append", "default": []}
    renamed = "test a function with another name as this operation"
    add("--as", **named, metavar="OPERATION=FUNCTION", help=renamed)
    lesson = "the assignment: all exercises of this lesson count (default: told by the file)"
    add("--lesson", default="", metavar="NN", help=lesson)
    others = "accept other documented conventions, such as the gates of a GRU in another order"
    add("--any-convention", action="store_true", help=others)
    seconds = "limit of the time for one file (default: 120 s)"
    add("--time-limit", type=kinds.positive, default=120.0, metavar="SECONDS", help=seconds)
    memory = "limit of the memory for one file, enforced on Linux (default: 2048 MB)"
    add("--memory-limit", type=kinds.positive, default=2048.0, metavar="MB", help=memory)
    kinds.add_shared(parser, "json")


def run(args: argparse.Namespace) -> int:
    """Grade each file; none of them can end the grading of the others."""
    from numpy_cae.cli.output import print_json, with_progress
    from numpy_cae.verify.grading import grade

    files = [file for path in args.files for file in _submissions(path)]
    if not any(file.is_file() for file in files):
        raise ValueError(f"nothing to grade: {', '.join(map(str, args.files))}")
    options = dict(args.named), args.time_limit, int(args.memory_limit), args.lesson
    options = *options, args.any_convention
    graded = [
        grade(file, "numpy_cae.course.catalogue", *options)
        for file in with_progress(files, len(files), "files graded")
    ]
    if args.json:
        print_json([file.as_json() for file in graded])
    else:
        print("\n\n".join(str(file) for file in graded))
    return 0 if all(file.held for file in graded) else 1


def _submissions(path: Path) -> list[Path]:
    """A file itself; of a folder, the Python files and notebooks in it and in its folders."""
    if not path.is_dir():
        return [path]
    inside = (file.relative_to(path) for file in path.rglob("*"))
    hidden = re.compile(r"(^|/)[.]")  # such as .ipynb_checkpoints
    found = (f for f in inside if f.suffix in (".py", ".ipynb") and not hidden.search(f.as_posix()))
    return [path / file for file in sorted(found)]


def _named(text: str) -> tuple[str, str]:
    operation, equals, function = text.partition("=")
    if not (operation and equals and function):
        raise argparse.ArgumentTypeError(f"expected OPERATION=FUNCTION, got {text!r}")
    return operation, function
