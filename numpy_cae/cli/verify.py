"""`numpy-cae verify FILE`: test the operations and exercises in someone's file, with points."""

from __future__ import annotations

import argparse
import importlib.util
import json
from pathlib import Path

EXAMPLE = """\
example: numpy-cae verify student.py --as conv1d=my_conv

Each file runs in a process of its own with limits on time and memory. This protects against
mistakes, not against an attack: the file can read and delete what its user can, use the network
and read the solutions in the source of numpy_cae. Grade files of people you do not trust in a
container. Exit status: 0 if every property holds, 1 if something fails, 2 if there was nothing to
grade."""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand that prints a table for each Python file."""
    parser = subparsers.add_parser(
        "verify",
        help="test the operations in a Python file for their properties, with points",
        description="Test the functions of a Python file that have the name of an operation of "
        "numpy_cae.ops (conv1d, gru, ...) for every property of that operation. Print for each "
        "property whether it holds, the smallest counterexample, and the likely mistake if the "
        "function behaves as a known wrong one does. In a lesson's notebook (.ipynb), test the "
        "functions in the exercise cells.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "files", type=Path, nargs="+", metavar="FILE", help="a Python file or a lesson's notebook"
    )
    parser.add_argument(
        "--as",
        dest="named",
        type=_named,
        action="append",
        default=[],
        metavar="OPERATION=FUNCTION",
        help="test a function with another name as this operation",
    )
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")
    parser.add_argument(
        "--time-limit",
        type=_positive,
        default=120.0,
        metavar="SECONDS",
        help="limit of the time for one file (default: 120 s)",
    )
    parser.add_argument(
        "--memory-limit",
        type=_positive,
        default=2048.0,
        metavar="MB",
        help="limit of the memory for one file, enforced on Linux (default: 2048 MB)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Grade each file; none of them can end the grading of the others."""
    if importlib.util.find_spec("hypothesis") is None:
        raise ValueError(
            "drawing examples needs hypothesis: pip install 'numpy_cae[test]', "
            "or pip install hypothesis"
        )
    from numpy_cae.verify.grading import grade

    for file in args.files:
        if not file.is_file():
            raise ValueError(f"{file}: there is no such file")
    catalogue, named = "numpy_cae.course.catalogue", dict(args.named)
    limits = args.time_limit, int(args.memory_limit)
    graded = [grade(file, catalogue, named, *limits) for file in args.files]
    if args.json:
        print(json.dumps([file.as_json() for file in graded], indent=2, ensure_ascii=False))
    else:
        print("\n\n".join(str(file) for file in graded))
    return 0 if all(file.held for file in graded) else 1


def _named(text: str) -> tuple[str, str]:
    operation, equals, function = text.partition("=")
    if not (operation and equals and function):
        raise argparse.ArgumentTypeError(f"expected OPERATION=FUNCTION, got {text!r}")
    return operation, function


def _positive(text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not 0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"expected a number above 0, got {text!r}")
    return number
