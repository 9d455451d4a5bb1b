"""Write copies of the package's lessons for students: a stub in place of each solution, no outputs,
and a mine.py to which solved functions are saved. Files that exist are kept. With --release, write
a zip file to be unpacked in the folder of an nbgrader course.

examples: numpy-cae lessons student/                     every lesson
          numpy-cae lessons student/ --only 03           one lesson
          numpy-cae lessons --release week3.zip 03 04    two lessons, for nbgrader

In a clone, --execute runs the instructor's copies in a fresh kernel, stores their outputs and
points, and writes the package's copies for students. --store does the same without running the
lessons, for instance after a change of their text.

example: numpy-cae lessons --execute --only 03
"""

import argparse
from pathlib import Path

from numpy_cae.cli.shared import arguments
from numpy_cae.course import copies
from numpy_cae.course.mine import mine_before
from numpy_cae.course.notebook import read_notebook, set_points, write_notebook


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The folders and what to do with the lessons."""
    add = parser.add_argument
    add("folder", type=Path, nargs="?", help="folder for the students' copies")
    release = "write a release for nbgrader of the lessons with these numbers (default: all)"
    add("--release", nargs="+", metavar=("FILE.zip", "NN"), help=release)
    source = "folder of the lessons (default: the package's, or lessons with --execute, --store)"
    add("--from", dest="source", **arguments.FOLDER, help=source)
    add("--execute", **arguments.FLAG, help="execute the instructor's copies")
    add("--store", **arguments.FLAG, help="as --execute, but keep the outputs that are stored")
    add("--only", metavar="NN", help="number of the only lesson to process")


def run(args: argparse.Namespace) -> int:
    """Write copies or a release, or execute or store the lessons, and print each file."""
    tasks = [args.execute, args.store, args.folder is not None, args.release is not None]
    if tasks.count(True) != 1:
        raise ValueError("give a folder for students, --release, --execute or --store")
    in_clone = args.execute or args.store
    source = args.source or (Path("lessons") if in_clone else copies.PACKAGED)
    file, *numbers = args.release or [None]
    lessons = copies.choose_lessons(source, [*numbers, *([args.only] if args.only else [])])
    if file:
        copies.write_release(lessons, Path(file))
        print(file)
    elif in_clone:
        for path in lessons:
            try:
                _store(path, args.execute)
            except ValueError as error:
                raise ValueError(f"{path}: {error}") from None
    else:
        for path, new in copies.write_copies(lessons, args.folder):
            print(path if new else f"{path} exists and is kept")
    return 0


def _store(path: Path, executed: bool) -> None:
    """Store a lesson's points and the package's copy and, if requested, new outputs."""
    from numpy_cae.course.executed import execute

    notebook = read_notebook(path)
    set_points(notebook)
    if executed:
        notebook = execute(notebook, mine_before(path))
        print(f"{path}: executed")
    write_notebook(notebook, path)
    copies.write_package_copy(path)
