"""Who handed a file in, and a file of feedback for each student."""

import re
import textwrap
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.catalogue import ASSIGNMENTS
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import visible

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


def write_feedback(folder: Path, graded: Iterable[tuple[str, FileReport]]) -> None:
    """Write one Markdown file for each student, with the report on each exercise.

    A file is named after the student. If the name has other characters than letters, digits, _ and
    -, is long or differs from another only in its capitals, a dot and a number follow.
    """
    folder.mkdir(parents=True, exist_ok=True)
    of_students = by_student(graded)
    counts = Counter(student.casefold() for student in of_students)
    for number, (student, files) in enumerate(of_students.items(), 1):
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


def by_student(graded: Iterable[tuple[str, FileReport]]) -> dict[str, list[FileReport]]:
    """The reports on the files of each student, by name."""
    files = defaultdict(list)
    for student, report in graded:
        files[student].append(report)
    return dict(sorted(files.items()))
