"""Write the student's copy of every lesson: a stub in place of each solution, no outputs. With
--execute, run the instructor's copies in a fresh kernel instead and store their outputs and the
pictures of the gallery. With --gallery, make the pictures from the stored outputs.

examples: numpy-cae lessons student/              write the student's copy of every lesson
          numpy-cae lessons --execute             execute the instructor's copies
          numpy-cae lessons --execute --only 03   of one lesson
          numpy-cae lessons --gallery             pictures from the stored outputs
"""

import argparse
import time
from pathlib import Path

from numpy_cae import course
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.output import working


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The folders and what to do with the lessons."""
    add = parser.add_argument
    add("folder", type=Path, nargs="?", help="folder for the student's copies")
    source = "folder of the instructor's copies (default: lessons, as in a clone)"
    add("--from", dest="source", **kinds.FOLDER, default=Path("lessons"), help=source)
    add("--execute", **kinds.FLAG, help="execute the instructor's copies")
    add("--gallery", **kinds.FLAG, help="make the pictures from stored outputs, without execution")
    add("--only", metavar="NN", help="number of the only lesson to process")


def run(args: argparse.Namespace) -> int:
    """Write, execute or make pictures, and print each file."""
    if [args.execute, args.gallery, args.folder is not None].count(True) != 1:
        raise ValueError(
            "expected either a folder for the student's copies or --execute or --gallery"
        )
    lessons = course.find_lessons(args.source)
    if args.only:
        lessons = [path for path in lessons if path.name.startswith(f"{args.only}_")]
        if not lessons:
            raise ValueError(f"no lesson {args.only} in {args.source}")
    if args.folder is not None:
        _write_copies(lessons, args.folder)
        return 0
    for path in lessons:
        try:
            _make_picture(path, args.execute)
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None
    return 0


def _make_picture(path: Path, executed: bool) -> None:
    """Make a lesson's picture and, if requested, execute it before that."""
    notebook = course.with_points(course.read_notebook(path))
    if executed:
        began = time.monotonic()
        with working(str(path)):
            notebook = course.execute(notebook, course.mine_before(path))
        course.write_notebook(notebook, path)
        print(f"{path}: run in {time.monotonic() - began:.0f} s")
    print(course.write_picture(notebook, path))


def _write_copies(lessons: list[Path], folder: Path) -> None:
    if any(folder.resolve() == path.parent.resolve() for path in lessons):
        raise ValueError(f"{folder} holds the instructor's copies: name another folder")
    folder.mkdir(parents=True, exist_ok=True)
    there = [path.name for path in lessons if (folder / path.name).exists()]
    if there:
        raise ValueError(
            f"{folder} has {', '.join(there)} already, perhaps with a student's work: "
            "name another folder or move the files"
        )
    if not (folder / course.FILE).exists():
        (folder / course.FILE).write_text(course.EMPTY, encoding="utf-8")
    for path in lessons:
        course.write_notebook(course.student_copy(course.read_notebook(path)), folder / path.name)
        print(folder / path.name)
