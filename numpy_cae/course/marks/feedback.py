"""A file of feedback for each student."""

import os
import re
import textwrap
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import visible

LONGEST_NAME = 50
"""LONGEST_NAME: a file of feedback has so many characters of the student's name; a character may
take four bytes, and systems allow 255 in a name."""
INDENT = " " * 4  # a block of code in Markdown, whose text does nothing else


def write_feedback(folder: Path, of_students: Mapping[str, Sequence[FileReport]]) -> None:
    """Write one Markdown file for each student, with the report on each exercise.

    A file is named after the student. If the name has other characters than letters, digits, _ and
    -, is long or differs from another only in its capitals, a dot and a number follow.
    """
    folder.mkdir(parents=True, exist_ok=True)
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
        name = f"{safe}.md" if is_unique else f"{safe}.{number}.md"
        file_name = os.fsdecode(name.encode("utf-8", "surrogateescape"))  # UTF-8 in every locale
        with atomic_write(folder / file_name) as temporary:
            temporary.write_text(visible("\n".join(lines)), encoding="utf-8")
