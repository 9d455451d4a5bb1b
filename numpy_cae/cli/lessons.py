"""`numpy-cae lessons student/`: the students' copies of the lessons, without the solutions."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from numpy_cae.course import (
    execute,
    find_lessons,
    read_notebook,
    student_copy,
    write_notebook,
    write_picture,
)

EXAMPLE = """\
examples: numpy-cae lessons student/              write the student's copy of every lesson
          numpy-cae lessons --execute             execute the instructor's copies
          numpy-cae lessons --execute --only 03   of one lesson
          numpy-cae lessons --gallery             pictures from the stored outputs"""


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser(
        "lessons",
        help="write the student's copies of the lessons, or execute the instructor's",
        description="Write the student's copy of every lesson: a stub in place of each solution, "
        "no outputs. With --execute, run the instructor's copies in a fresh kernel instead and "
        "store their outputs and the pictures of the gallery. With --gallery, make the pictures "
        "from the stored outputs.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("folder", type=Path, nargs="?", help="folder for the student's copies")
    parser.add_argument(
        "--from",
        dest="source",
        type=Path,
        default=Path("lessons"),
        metavar="FOLDER",
        help="folder of the instructor's copies (default: lessons, as in a clone)",
    )
    parser.add_argument("--execute", action="store_true", help="execute the instructor's copies")
    parser.add_argument(
        "--gallery",
        action="store_true",
        help="make the pictures from stored outputs, without execution",
    )
    parser.add_argument("--only", metavar="NN", help="number of the only lesson to process")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Write, execute or make pictures, and print each file."""
    if [args.execute, args.gallery, args.folder is not None].count(True) != 1:
        raise ValueError(
            "expected either a folder for the student's copies or --execute or --gallery"
        )
    lessons = find_lessons(args.source)
    if args.only:
        lessons = [path for path in lessons if path.name.startswith(f"{args.only}_")]
        if not lessons:
            raise ValueError(f"no lesson {args.only} in {args.source}")
    if args.folder is not None:
        return _write_copies(lessons, args.folder)
    return _execute(lessons) if args.execute else _gallery(lessons)


def _execute(lessons: list[Path]) -> int:
    for path in lessons:
        began = time.monotonic()
        try:
            executed = execute(read_notebook(path))
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
        write_notebook(executed, path)
        print(f"{path}: run in {time.monotonic() - began:.0f} s")
        print(write_picture(executed, path))
    return 0


def _gallery(lessons: list[Path]) -> int:
    for path in lessons:
        try:
            print(write_picture(read_notebook(path), path))
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    return 0


def _write_copies(lessons: list[Path], folder: Path) -> int:
    if any(folder.resolve() == path.parent.resolve() for path in lessons):
        raise ValueError(f"{folder} holds the instructor's copies: name another folder")
    folder.mkdir(parents=True, exist_ok=True)
    there = [path.name for path in lessons if (folder / path.name).exists()]
    if there:
        raise ValueError(
            f"{folder} has {', '.join(there)} already, perhaps with a student's work: "
            "name another folder or move the files"
        )
    for path in lessons:
        write_notebook(student_copy(read_notebook(path)), folder / path.name)
        print(folder / path.name)
    return 0
