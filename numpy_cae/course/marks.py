"""Marks of a class: a row of points for each student, and a file of feedback for each."""

import csv
import re
import textwrap
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.catalogue import ASSIGNMENTS, CATALOGUE
from numpy_cae.verify.grading.report import Report
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import csv_cell, visible

LESSON_FIRST = re.compile(r"^\d\d_")
LONGEST_NAME = 50
"""LONGEST_NAME: a file of feedback has so many characters of the student's name; a character may
take four bytes, and systems allow 255 in a name."""
INDENT = " " * 4  # a block of code in Markdown, whose text does nothing else


def student_id(file: Path, folder: Path) -> str:
    """The student who handed a file in: the first folder inside `folder`, or else the file's name.

    nbgrader's submitted/ann/week3/03_convolution_by_hand.ipynb and submitted/ann/03.ipynb are ann's
    where `folder` is submitted; ann_03.ipynb, 03_ann.ipynb and ann.ipynb are ann's too.
    """
    first, *rest = file.relative_to(folder).parts
    if rest:
        return first
    name = file.stem.removesuffix(f"_{lesson_of(file)}")
    return LESSON_FIRST.sub("", name) or name


def lesson_of(file: Path) -> str:
    """The lesson at the end of a name such as ann_03.py, or ""."""
    last = file.stem.rpartition("_")[2]
    return last if last in ASSIGNMENTS and not LESSON_FIRST.match(file.stem) else ""


def write_csv(path: Path, graded: Iterable[tuple[str, FileReport]]) -> None:
    """Write one row for each student: the points of each exercise, their sum, and what is wrong.

    If an exercise was handed in more than once, the best attempt counts. The cell of an exercise
    that was not handed in is empty. The points possible are those of all columns.
    """
    by_student = _by_student(graded)
    best = {student: _best(files) for student, files in by_student.items()}
    names = [name for name in CATALOGUE if any(name in reports for reports in best.values())]
    names.sort(key=[*sum(ASSIGNMENTS.values(), ()), *CATALOGUE].index)
    possible = sum(CATALOGUE[name].points for name in names)
    with atomic_write(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["student", *names, "total", "possible", "problems"])
        for student, reports in best.items():
            points = [reports[name].points if name in reports else "" for name in names]
            total = sum(report.points for report in reports.values())
            problems = "; ".join(fault for each in by_student[student] for fault in each.faults)
            writer.writerow([csv_cell(student), *points, total, possible, csv_cell(problems)])


def write_feedback(folder: Path, graded: Iterable[tuple[str, FileReport]]) -> None:
    """Write one Markdown file for each student, with the report on each exercise.

    A file is named after the student. If the name has other characters than letters, digits, _ and
    -, is long or differs from another only in its capitals, a dot and a number follow.
    """
    folder.mkdir(parents=True, exist_ok=True)
    by_student = _by_student(graded)
    counts = Counter(student.casefold() for student in by_student)
    for number, (student, files) in enumerate(by_student.items(), 1):
        lines = []
        for each in files:
            lines += [f"# {each.points} of {each.possible} points", ""]
            problems = "\n".join([each.path.name, *each.faults])
            lines += [textwrap.indent(problems, INDENT), ""]
            for report in each.reports:
                title = f"## {report.operation}: {report.points} of {report.possible} points"
                lines += [title, "", textwrap.indent(str(report), INDENT), ""]
        safe = re.sub(r"[^\w-]", "_", student)[:LONGEST_NAME]
        # No safe name has a dot, so that one with a number is nobody else's.
        is_unique = safe == student and counts[student.casefold()] == 1
        name = safe if is_unique else f"{safe}.{number}"
        with atomic_write(folder / f"{name}.md") as temporary:
            temporary.write_text(visible("\n".join(lines)), encoding="utf-8")


def _by_student(graded: Iterable[tuple[str, FileReport]]) -> dict[str, list[FileReport]]:
    files = defaultdict(list)
    for student, report in graded:
        files[student].append(report)
    return dict(sorted(files.items()))


def _best(files: list[FileReport]) -> dict[str, Report]:
    best: dict[str, Report] = {}
    for report in (report for each in files for report in each.reports):
        other = best.setdefault(report.operation, report)
        best[report.operation] = max(other, report, key=lambda each: each.points)
    return best
