"""A file of feedback for each student."""

import os
import re
import textwrap
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import visible

LONGEST_NAME = 50
"""A file of feedback has so many characters of the student's name; a character may take four
bytes, and systems allow 255 in a name."""
INDENT = " " * 4
"""What makes a block of code in Markdown, whose text does nothing else."""


def write_feedback(folder: Path, reports_of: Mapping[str, Sequence[FileReport]]) -> None:
    """Write one Markdown file for each student, with the report on each exercise.

    A file is named after the student. If the name has other characters than letters, digits, _ and
    -, is long or differs from another only in its capitals, a dot and a number follow.
    """
    folder.mkdir(parents=True, exist_ok=True)
    counts = Counter(student.casefold() for student in reports_of)
    for number, (student, files) in enumerate(reports_of.items(), 1):
        safe = re.sub(r"[^\w-]", "_", student)[:LONGEST_NAME]
        # No safe name has a dot, so that one with a number is nobody else's.
        is_unique = safe == student and counts[student.casefold()] == 1
        name = f"{safe}.md" if is_unique else f"{safe}.{number}.md"
        file_name = os.fsdecode(name.encode("utf-8", "surrogateescape"))  # UTF-8 in every locale
        with atomic_write(folder / file_name) as temporary:
            temporary.write_text(visible("\n".join(_lines(files))), encoding="utf-8")


def _lines(files: Sequence[FileReport]) -> Iterator[str]:
    """The lines of the feedback on a student's files."""
    for file in files:
        problems = "\n".join([file.path.name, *file.faults])
        yield from (f"# {file.points} of {file.possible} points", "")
        yield from (textwrap.indent(problems, INDENT), "")
        for report in file.reports:
            yield f"## {report.operation}: {report.points} of {report.possible} points"
            yield from ("", textwrap.indent(str(report), INDENT), "")
