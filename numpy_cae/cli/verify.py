"""Test the functions of a Python file that have the name of an operation of numpy_cae.ops (conv1d,
gru, ...) for every property of that operation. Print for each property whether it holds, the
smallest counterexample, and the likely mistake if the function behaves as a known wrong one does.
In a lesson's notebook (.ipynb), test the functions in the exercise cells.

example: numpy-cae verify student.py --as conv1d=my_conv

Each file runs in a process of its own with limits on time and memory. This
protects against mistakes, not against an attack: the file can read and delete
what its user can, use the network and read the solutions in the source of
numpy_cae. Grade files of people you do not trust in a container. Exit status:
0 if every property holds, 1 if something fails, 2 if there was nothing to grade.
"""

import argparse
import importlib.util
from typing import Any

from numpy_cae.cli import arguments as kinds


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the names of functions and the limits."""
    add = parser.add_argument
    add("files", **kinds.FILE, nargs="+", help="a Python file or a lesson's notebook")
    named: dict[str, Any] = {"dest": "named", "type": _named, "action": "append", "default": []}
    renamed = "test a function with another name as this operation"
    add("--as", **named, metavar="OPERATION=FUNCTION", help=renamed)
    seconds = "limit of the time for one file (default: 120 s)"
    add("--time-limit", type=kinds.positive, default=120.0, metavar="SECONDS", help=seconds)
    memory = "limit of the memory for one file, enforced on Linux (default: 2048 MB)"
    add("--memory-limit", type=kinds.positive, default=2048.0, metavar="MB", help=memory)
    kinds.add_shared(parser, "json")


def run(args: argparse.Namespace) -> int:
    """Grade each file; none of them can end the grading of the others."""
    if importlib.util.find_spec("hypothesis") is None:
        raise ValueError("drawing examples needs hypothesis: pip install hypothesis")
    from numpy_cae.cli.output import print_json
    from numpy_cae.verify.grading import grade

    for file in args.files:
        if not file.is_file():
            raise ValueError(f"{file}: there is no such file")
    catalogue, named = "numpy_cae.course.catalogue", dict(args.named)
    limits = args.time_limit, int(args.memory_limit)
    graded = [grade(file, catalogue, named, *limits) for file in args.files]
    if args.json:
        print_json([file.as_json() for file in graded])
    else:
        print("\n\n".join(str(file) for file in graded))
    return 0 if all(file.held for file in graded) else 1


def _named(text: str) -> tuple[str, str]:
    operation, equals, function = text.partition("=")
    if not (operation and equals and function):
        raise argparse.ArgumentTypeError(f"expected OPERATION=FUNCTION, got {text!r}")
    return operation, function
