"""A file of feedback for each student."""

import json
import os
import re
import textwrap
import zipfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from numpy_cae.atomic_write import atomic_write, make_folder, stamped
from numpy_cae.course.marks.handed_in import HandedIn
from numpy_cae.errors import FileError
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import visible

LONGEST_NAME = 50
"""A file of feedback has at most this many characters of the student's name; a character may take
four bytes, and systems allow 255 in a name."""
MOODLE_PREFIX = "_assignsubmission_"
INDENT = " " * 4
"""What makes a block of code in Markdown, whose text does nothing else."""


def write_feedback(folder: Path, reports_of: Mapping[str, Sequence[FileReport]]) -> None:
    """Write one Markdown file for each student, with the report on each exercise.

    A file is named after the student. If the name has other characters than letters, digits, _ and
    -, is long or differs from another only in its capitals, a dot and a number follow.

    Raises ValueError, when all others are written, with the files that cannot be written: feedback
    that a teacher has edited is only replaced with --overwrite.
    """
    kept: list[FileError] = []
    make_folder(folder)
    counts = Counter(student.casefold() for student in reports_of)
    for number, (student, files) in enumerate(reports_of.items(), 1):
        safe = re.sub(r"[^\w-]", "_", student)[:LONGEST_NAME]
        # No safe name has a dot, so that one with a number is nobody else's.
        is_unique = safe == student and counts[student.casefold()] == 1
        name = f"{safe}.md" if is_unique else f"{safe}.{number}.md"
        file_name = os.fsdecode(name.encode("utf-8", "surrogateescape"))  # UTF-8 in every locale
        text = stamped(visible("\n".join(_lines(files))))
        try:
            with atomic_write(folder / file_name) as temporary:
                temporary.write_text(text, encoding="utf-8", newline="\n")
        except FileError as error:
            kept.append(error)
    if kept:
        raise ValueError("\n".join(map(str, kept)))


def write_feedback_zip(path: Path, marked: Sequence[tuple[HandedIn, FileReport]]) -> None:
    """Write the feedback on each file of a download into a zip that its system takes back.

    Moodle reads whose feedback a file is from the number in Ann Lee_12_assignsubmission_file_ at
    the beginning of its name, Canvas from both numbers in leeann_12345_67890_. Canvas shows the
    file under the name of what was handed in, so that the feedback on a notebook is a notebook.
    A ValueError says that no file is of a download.
    """
    texts: dict[str, str] = {}
    suffixes: dict[str, str] = {}
    for file, report in marked:
        if file.prefix:
            text = visible("\n".join(_lines([report])))
            texts[file.prefix] = texts.get(file.prefix, "") + text + "\n"
            suffixes.setdefault(file.prefix, file.path.suffix)
    if not texts:
        raise ValueError(f"{path}: no file has a name that Moodle or Canvas gave; name a folder")
    with atomic_write(path) as temporary, zipfile.ZipFile(temporary, "w") as packed:
        for prefix, text in texts.items():
            is_canvas = MOODLE_PREFIX not in prefix
            suffix = ".md"
            if is_canvas and suffixes[prefix] == ".ipynb":
                suffix = ".ipynb"
                text = _as_notebook(text)
            name = f"{prefix}_feedback{suffix}".replace("/", "_")
            packed.writestr(name.encode("utf-8", "backslashreplace").decode(), text)


def _as_notebook(text: str) -> str:
    """A notebook that has a text in one cell."""
    cell = {"cell_type": "markdown", "id": "feedback", "metadata": {}, "source": text}
    return json.dumps({"cells": [cell], "metadata": {}, "nbformat": 4, "nbformat_minor": 5})


def _lines(files: Sequence[FileReport]) -> Iterator[str]:
    """The lines of the feedback on a student's files."""
    for file in files:
        problems = "\n".join([file.path.name, *file.faults])
        yield from (f"# {file.points} of {file.possible} points", "")
        yield from (textwrap.indent(problems, INDENT), "")
        for report in file.reports:
            yield f"## {report.operation}: {report.points} of {report.possible} points"
            yield from ("", textwrap.indent(str(report), INDENT), "")
