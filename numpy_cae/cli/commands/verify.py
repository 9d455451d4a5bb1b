"""Test the functions of a Python file that have the name of an operation of numpy_cae.ops (conv1d,
gru, ...) for every property of that operation. Print for each property whether it holds, the
smallest counterexample, and the likely mistake if the function behaves as a known wrong one does.
In a lesson's notebook (.ipynb), test the functions in the exercise cells.

examples, after `numpy-cae lessons student/`:
  numpy-cae verify student/03_convolution_by_hand.ipynb
  numpy-cae verify student/ --csv marks.csv --feedback feedback/
  numpy-cae verify download.zip --csv marks.csv --roster grades.csv --feedback feedback.zip

A file that imports numpy_cae gets no points: the operations are to be written by hand.
NumPy and the standard library may be imported.

Points are counted for all exercises of one lesson: --lesson or, without it, the
lesson of the notebook's cells or of a file name such as 03_mine.py. A file of no
lesson is graded for the functions that it has.

With --csv, the student is the folder submitted/ann/... in the folder that is graded,
or is in the file's name: ann_03.ipynb, 03_ann.ipynb, or as Moodle and Canvas name
downloads. Zip files are opened. If an exercise was handed in more than once, the best
attempt counts, also over several runs: a mark of an existing table stays unless a
better one replaces it, and the old table is kept with a number in its name. The table
is written after each file. A file corrections.csv beside the table (student, exercise,
points, reason) has marks that count in place of any other.

With --roster every student of the roster has a row. The command prints which file
belongs to which row, the files without a row first. marks_import.csv is the roster
with the points of each lesson: in the column Grade of Moodle's grading worksheet, in
Canvas's column "Lesson 03 (8811)", else in a column of its own. If a file without a
row may belong to some row, that row stays as it is and the exit status is 1. The
import is not written if most submissions or most rows have no match.

Each function runs in a process of its own with limits on time, memory and files; its
results are compared in another. On Linux the kernel lets the process change files in a
temporary folder only, start nothing and connect to nothing. If the kernel cannot do
this, the command says so before it grades a class; then grade files of people you do
not trust in a container. Exit status: 0 if every property holds, 1 if
something fails, 2 if there was nothing to grade.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from numpy_cae.atomic_write import require_free
from numpy_cae.cli.shared import arguments

if TYPE_CHECKING:
    from numpy_cae.course.marks.class_marks import ClassMarks
    from numpy_cae.verify.grading.student_file import FileReport

Grade = Callable[[], "FileReport"]
"""Grades one file."""
LARGEST_LIMIT = 1e6
"""Seconds, and megabytes; the system's own limits take whole numbers of bytes that are not much
larger."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, the names of functions and the limits."""
    add = parser.add_argument
    file = dict(arguments.FILE)
    add("files", **file, nargs="+", help="Python files, notebooks of lessons, folders or zip files")
    add("--lesson", default="", metavar="NN", help="lesson of the exercises (default: the file's)")
    for name, unit, most in (("time", "SECONDS", 30.0), ("memory", "MB", 2048.0)):
        limit = {"type": arguments.positive, "default": most, "metavar": unit}
        add(f"--{name}-limit", **limit, help=f"{name} for one function at most (default: {most:g})")
    add("--csv", **file, help="table of marks to write, a row for each student, with statistics")
    add("--roster", **file, help="table of the students, from Moodle or Canvas (with --csv)")
    add("--late", **file, help="list of who was late, one a line (default: Canvas's LATE)")
    add("--teams", **file, help="list of teams, one a line: every member gets the team's marks")
    add(
        "--feedback",
        type=Path,
        metavar="FOLDER",
        help="write each student's reports to this folder, or to a .zip for Moodle or Canvas",
    )
    add("--json", **file, help="write student, exercise, points, possible and text for programs")
    arguments.add_shared(parser, "overwrite")


def run(args: argparse.Namespace) -> int:
    """Grade each file; none of them can end the grading of the others."""
    arguments.require_at_most("--time-limit", args.time_limit, LARGEST_LIMIT)
    arguments.require_at_most("--memory-limit", args.memory_limit, LARGEST_LIMIT)
    if (args.roster or args.late or args.teams) and not args.csv:
        raise ValueError("--roster, --late and --teams are about the table of --csv FILE")
    if args.csv and not args.overwrite:
        read = [path for path in (args.roster, args.late, args.teams, *args.files) if path]
        arguments.require_not_read(args.csv, read)
    for path in (args.json, args.feedback):
        if path and not path.is_dir():
            require_free(path)
    is_class = any(path.is_dir() or path.suffix == ".zip" for path in args.files)
    if is_class or args.csv or args.feedback or args.json:
        return _grade_class(args)
    return _grade_files(args)


def _grade_files(args: argparse.Namespace) -> int:
    """Grade files one by one, and print their reports."""
    from numpy_cae.verify.grading.submission import SUFFIXES

    if not any(path.is_file() and path.suffix in SUFFIXES for path in args.files):
        raise ValueError(_nothing_to_grade(args.files))
    reports = list(_grade_each([_grader_of(path, args) for path in args.files]))
    _print_reports(reports)
    return _status(reports)


def _grade_class(args: argparse.Namespace) -> int:
    """Grade the files of a class, write what the options name, and print who has which points."""
    from numpy_cae.course.marks.class_marks import ClassMarks
    from numpy_cae.course.marks.handed_in import HandedIn, find_files
    from numpy_cae.verify.grading.submission import SUFFIXES

    _require_different_outputs(args)
    with tempfile.TemporaryDirectory() as unpacked:
        files: list[HandedIn] = []
        for path in args.files:
            files += find_files(path, Path(unpacked))
        if not any(
            file.fault or (file.path.is_file() and file.path.suffix in SUFFIXES) for file in files
        ):
            raise ValueError(_nothing_to_grade(args.files))
        marks = ClassMarks(files, args.roster, args.late, args.teams, args.csv, args.lesson)
        reports = _grade_and_write(marks, args)
        if args.csv or args.feedback:
            print("\n".join(marks.lines(reports)))
        elif not args.json:
            _print_reports(reports)
        _write_outputs(marks, reports, args)
    return _status(reports) if marks.is_certain else 1


def _require_different_outputs(args: argparse.Namespace) -> None:
    """Raise ValueError if two options would write one file, or the marks would be written to the
    file of corrections."""
    from numpy_cae.course.marks import corrections
    from numpy_cae.course.marks.class_marks import import_path, statistics_path

    outputs = {"--json": args.json, "--feedback": args.feedback}
    if args.csv:
        if args.csv.name == corrections.FILE:
            raise ValueError(f"{args.csv}: is the name of the corrections of a table of marks")
        outputs["--csv"] = args.csv
        outputs["the statistics of --csv"] = statistics_path(args.csv)
        outputs["the import of --csv"] = import_path(args.csv)
    arguments.require_different(outputs)


def _grade_and_write(marks: "ClassMarks", args: argparse.Namespace) -> list["FileReport"]:
    """Grade the files of a class, and write the table of marks after each of them."""
    from numpy_cae.verify.grading.student_file import FileReport

    _warn_without_confinement()
    graders: list[Grade] = []
    for file in marks.files:
        if file.fault:
            graders.append(partial(FileReport, file.path, faults=[file.fault]))
        else:
            graders.append(_grader_of(file.path, args, file.lesson))
    marks.keep_older_tables()
    reports: list[FileReport] = []
    for report in _grade_each(graders):
        reports.append(report)
        waiting = [None] * (len(graders) - len(reports))
        if waiting:
            marks.write_marks([*reports, *waiting])
    return reports


def _write_outputs(
    marks: "ClassMarks", reports: Sequence["FileReport"], args: argparse.Namespace
) -> None:
    """Write the tables, the feedback and the results as JSON, as the options name them."""
    from numpy_cae.course.marks.feedback_files import write_feedback, write_feedback_zip
    from numpy_cae.course.marks.results_file import write_results

    try:
        if args.feedback and args.feedback.suffix == ".zip":
            write_feedback_zip(args.feedback, list(zip(marks.files, reports, strict=True)))
        elif args.feedback:
            write_feedback(args.feedback, marks.by_student(reports))
        if args.json:
            write_results(args.json, marks.by_student(reports))
    finally:  # marks are written although feedback that was edited is not replaced
        if args.csv:
            for line in marks.write_tables(reports):
                print(line)


def _warn_without_confinement() -> None:
    """Say before a class is graded that this system does not confine files, if it does not."""
    from numpy_cae.confined.confinement import LANDLOCK, SECCOMP, names_of_mechanisms

    missing = [name for name in (LANDLOCK, SECCOMP) if name not in names_of_mechanisms()]
    if missing:
        text = f"this system has no {' and no '.join(missing)}: a file can change what you can"
        print(f"{text} (docs/grading_files.md, What is not guarded)", file=sys.stderr)


def _nothing_to_grade(paths: Sequence[Path]) -> str:
    """Why there is nothing to grade at some paths."""
    missing = [path for path in paths if not path.exists()]
    names = ", ".join(map(str, missing or paths))
    problem = "there is no such file" if missing else "no Python file and no notebook"
    return f"{names}: {problem}"


def _grader_of(path: Path, args: argparse.Namespace, lesson: str = "") -> Grade:
    """The function that grades a file with the limits of the command."""
    from numpy_cae.course import catalogue
    from numpy_cae.verify.grading.student_file import grade

    lesson = args.lesson or lesson
    return partial(grade, path, catalogue, args.time_limit, int(args.memory_limit), lesson)


def _grade_each(graders: Sequence[Grade]) -> Iterator["FileReport"]:
    """Grade files, several at once, since each of them waits for its process."""
    from numpy_cae.cli.shared.output import with_progress

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        reports = pool.map(lambda grade_file: grade_file(), graders)
        yield from with_progress(reports, len(graders), "file")


def _print_reports(reports: Sequence["FileReport"]) -> None:
    print("\n\n".join(str(report) for report in reports))


def _status(reports: Sequence["FileReport"]) -> int:
    """The exit status: 0 if every property of every file holds."""
    return 0 if all(report.held for report in reports) else 1
