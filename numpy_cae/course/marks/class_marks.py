"""The marks of a class: its files, its roster, and what is written about them.

Each student gets a file of feedback.
"""

import os
import re
import textwrap
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.marks import tables
from numpy_cae.course.marks.handed_in import HandedIn
from numpy_cae.course.marks.roster import Matching, decoded, match, read_roster, squashed
from numpy_cae.course.marks.similar import similar_pairs
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.verify.grading.submission import read_submission
from numpy_cae.visible import csv_cell, visible

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


class ClassMarks:
    """The files of a class, with the roster and who in it handed them in, if there is one.

    Reads the roster and the list of who was late; a ValueError says what is wrong.
    """

    def __init__(self, files: Sequence[HandedIn], roster: Path | None, late: Path | None):
        self.files = files
        self.roster = read_roster(roster) if roster else None
        self.matching = match(files, self.roster) if self.roster else Matching({}, {}, ())
        listed = decoded(late.read_bytes())[0].splitlines() if late else []
        names = {squashed(line) for line in listed} - {""}
        self.late = {
            each.path
            for each in files
            if each.is_late
            or names & {squashed(n) for n in (*each.called, self.matching.key(each.student))}
        }

    def lines(self, graded: Sequence[FileReport]) -> Iterator[str]:
        """Who was matched by what, and the points of each file."""
        yield from self.matching.lines()
        for student, reports in self.by_student(graded).items():
            for each in reports:
                yield f"{student}: {each.path.name}: {each.points} of {each.possible} points"

    def similar(self) -> Iterator[str]:
        """The pairs of students whose files are alike."""
        submissions = defaultdict(list)
        for each in self.files:
            submissions[self.matching.key(each.student)].append(read_submission(each.path))
        yield "alike after renaming, as a sign to look and not as a verdict:"
        for share, one, other in similar_pairs(submissions):
            yield f"  {share:4.0%}  {one}  {other}"

    def write_tables(self, path: Path, graded: Sequence[FileReport]) -> None:
        """Write the table of marks and, with a roster, the file to import.

        Raises a ValueError in place of that file if most submissions or most rows have no match.
        """
        table = tables.write_tables(path, self.by_student(graded), self.roster, self.late)
        if self.roster is None:
            return
        imported = path.with_stem(f"{path.stem}_import")
        strangers = len(self.matching.missing)
        without = {row["student"] for row in table if row.get("problems") == tables.NOTHING}
        empty = sum(csv_cell(student) in without for student in self.roster.students)
        if strangers > len(self.matching.found):
            raise ValueError(f"{imported} is not written: {strangers} students have no row (above)")
        if 2 * empty > len(self.roster.students):
            raise ValueError(f"{imported} is not written: {empty} rows of the roster have no marks")
        tables.write_import(imported, self.roster, table)

    def by_student(self, graded: Sequence[FileReport]) -> dict[str, list[FileReport]]:
        """The reports on the files of each student, by name."""
        found = defaultdict(list)
        for each, report in zip(self.files, graded, strict=True):
            found[self.matching.key(each.student)].append(report)
        return dict(sorted(found.items()))
