"""The marks of a class: tables of them, and a file that Moodle and Canvas import."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

from numpy_cae.course.marks.handed_in import HandedIn
from numpy_cae.course.marks.marks_table import (
    NOTHING_HANDED_IN,
    MarksTable,
    best_reports,
    make_table,
    read_marks,
)
from numpy_cae.course.marks.matching import letters_and_digits, match_students
from numpy_cae.course.marks.roster import EMPTY_ROSTER, decode, read_roster
from numpy_cae.course.marks.statistics import write_statistics
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import csv_cell


class ClassMarks:
    """The files of a class, with the roster and who in it handed them in, if there is one.

    Reads the roster and the list of who was late; a ValueError says what is wrong.
    """

    def __init__(self, files: Sequence[HandedIn], roster: Path | None, late: Path | None):
        self.files = files
        self.roster = EMPTY_ROSTER
        self.row_of: dict[str, str] = {}  # the row of the roster by the student of a file
        self.matching: list[str] = []
        if roster:
            self.roster = read_roster(roster)
            self.row_of, self.matching = match_students(files, self.roster)
        self.late = self._late_files(late)

    def student_of(self, file: HandedIn) -> str:
        """The name in the table of marks of who handed a file in."""
        return self.row_of.get(file.student, file.student)

    def _late_files(self, late: Path | None) -> set[Path]:
        """The files that Canvas calls late, and those of students in the list of who was late."""
        lines = decode(late.read_bytes())[0].splitlines() if late else []
        listed = {letters_and_digits(line) for line in lines} - {""}
        files = set()
        for file in self.files:
            names = {letters_and_digits(name) for name in (*file.names, self.student_of(file))}
            if file.is_late or names & listed:
                files.add(file.path)
        return files

    def lines(self, reports: Sequence[FileReport]) -> Iterator[str]:
        """Who was matched by what, and the points of each file."""
        yield from self.matching
        for student, files in self.by_student(reports).items():
            for file in files:
                yield f"{student}: {file.path.name}: {file.points} of {file.possible} points"

    def by_student(self, reports: Sequence[FileReport]) -> dict[str, list[FileReport]]:
        """The reports on the files of each student, by name; `reports` has one for each file."""
        reports_of = defaultdict(list)
        for file, report in zip(self.files, reports, strict=True):
            reports_of[self.student_of(file)].append(report)
        return dict(sorted(reports_of.items()))

    def write_tables(self, path: Path, reports: Sequence[FileReport]) -> None:
        """Write the table of marks, the statistics beside it and, with a roster, the import.

        Where the table exists, exercises that are not handed in now keep their marks, and what is
        no number, such as "excused", is kept; the old table is kept under a name with a number.
        Raises a ValueError in place of the import if most submissions or most rows have no match.
        """
        reports_of = self.by_student(reports)
        table = make_table(reports_of, self.roster.students, self.late, read_marks(path))
        table.write(path)
        best = [best_reports(files) for files in reports_of.values()]
        write_statistics(path.with_stem(f"{path.stem}_statistics"), best)
        if self.roster.students:
            self._write_import(path.with_stem(f"{path.stem}_import"), table)

    def _write_import(self, path: Path, table: MarksTable) -> None:
        """Write the roster with the points of each lesson."""
        rows = {row.student: row for row in table.rows}
        row_of = {student: rows[csv_cell(student)] for student in self.roster.students}
        strangers = len({file.student for file in self.files} - self.row_of.keys())
        empty = sum(row.problems == [NOTHING_HANDED_IN] for row in row_of.values())
        if strangers > len(self.row_of):
            raise ValueError(f"{path} is not written: {strangers} students have no row (above)")
        if 2 * empty > len(row_of):
            raise ValueError(f"{path} is not written: {empty} rows of the roster have no marks")
        points = {student: table.lesson_points(row) for student, row in row_of.items()}
        self.roster.write_with(path, points, table.lesson_points(table.maximum()))
