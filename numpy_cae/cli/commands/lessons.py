"""Write copies of the package's lessons for students: a stub in place of each solution, no outputs,
and a mine.py to which solved functions are saved. Files that exist are kept. With --release, write
a zip file to be unpacked in the folder of an nbgrader course.

examples: numpy-cae lessons student/                     every lesson
          numpy-cae lessons student/ --only 03           one lesson
          numpy-cae lessons --release week3.zip 03 04    two lessons, for nbgrader
"""

import argparse
from pathlib import Path

from numpy_cae.cli.shared import arguments
from numpy_cae.course import copies


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The folders and what to do with the lessons."""
    add = parser.add_argument
    add("folder", type=Path, nargs="?", help="folder for the students' copies")
    release = "write a release for nbgrader of the lessons with these numbers (default: all)"
    add("--release", nargs="+", metavar=("FILE.zip", "NN"), help=release)
    source = "folder of the lessons (default: the package's)"
    add("--from", dest="source", default=copies.lessons_folder(), **arguments.FOLDER, help=source)
    add("--only", metavar="NN", help="number of the only lesson to write")
    arguments.add_shared(parser, "overwrite")


def run(args: argparse.Namespace) -> int:
    """Write copies or a release, and print each file."""
    if (args.folder is None) == (args.release is None):
        raise ValueError("give a folder for students or --release")
    numbers = args.release[1:] if args.release else []
    lessons = copies.choose_lessons(args.source, [*numbers, *([args.only] if args.only else [])])
    if args.release:
        file = Path(args.release[0])
        copies.write_release(lessons, file)
        print(file)
        return 0
    for path, new in copies.write_copies(lessons, args.folder):
        print(path if new else f"{path} exists and is kept")
    return 0
