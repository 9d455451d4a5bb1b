"""`numpy-cae verify student.py`: the properties of every operation, on anyone's implementation."""

from __future__ import annotations

import argparse
import json
import tempfile
from pathlib import Path

EXAMPLE = """\
example: numpy-cae verify student.py --as conv1d=my_conv

The file runs in a process of its own and never in the grader's. Exit status: 0 if every property
held, 1 if something fails, 2 if there was nothing to grade."""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Python files in, a table for each out."""
    parser = subparsers.add_parser(
        "verify",
        help="hold the operations in a Python file to their properties, with points",
        description="Hold the functions of a Python file that bear the name of an operation of "
        "numpy_cae.ops (conv1d, gru, ...) to every property of that operation, and say for each "
        "whether it held, the smallest counterexample and the likely mistake. Of a lesson's "
        "notebook (.ipynb) the exercise cells are held to what the lesson asks of them.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "files", type=Path, nargs="+", metavar="FILE", help="a Python file or a lesson"
    )
    parser.add_argument(
        "--as",
        dest="named",
        type=_named,
        action="append",
        default=[],
        metavar="OPERATION=FUNCTION",
        help="try a function with another name as this operation",
    )
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")
    parser.add_argument(
        "--time-limit", type=_positive, default=120.0, metavar="SECONDS", help="a file; default 120"
    )
    parser.add_argument(
        "--memory-limit",
        type=_positive,
        default=2048.0,
        metavar="MB",
        help="where the platform has one; default 2048",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Grade each file; none of them can end the grading of the others."""
    try:
        from hypothesis.configuration import set_hypothesis_home_dir

        from numpy_cae.verify.grading import grade
    except ImportError:
        raise ValueError(
            "drawing examples needs hypothesis: pip install 'numpy_cae[test]', "
            "or pip install hypothesis"
        ) from None
    for file in args.files:
        if not file.is_file():
            raise ValueError(f"{file}: there is no such file")
    with tempfile.TemporaryDirectory() as folder:
        set_hypothesis_home_dir(folder)  # lest it leave a .hypothesis wherever one grades
        graded = [
            grade(
                file,
                "numpy_cae.course.catalogue",
                dict(args.named),
                args.time_limit,
                int(args.memory_limit),
            )
            for file in args.files
        ]
        set_hypothesis_home_dir(None)
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
