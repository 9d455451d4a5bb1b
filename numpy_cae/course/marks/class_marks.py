"""The marks of a class: tables of them, and a file that Moodle and Canvas import."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path

from numpy_cae.course.catalogue import ASSIGNMENTS
from numpy_cae.course.marks.corrections import FILE, Correction, read_corrections
from numpy_cae.course.marks.gradebook import find_columns, import_notes, write_import
from numpy_cae.course.marks.handed_in import HandedIn
from numpy_cae.course.marks.marks_table import (
    NOTHING_HANDED_IN,
    MarksTable,
    Row,
    best_reports,
    keep_table,
    make_table,
    read_marks,
)
from numpy_cae.course.marks.matching import (
    Matching,
    find_row,
    letters_and_digits,
    match_students,
)
from numpy_cae.course.marks.roster import EMPTY_ROSTER, read_roster, read_text
from numpy_cae.course.marks.statistics import write_statistics
from numpy_cae.course.marks.teams import read_teams
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import csv_cell


class ClassMarks:
    """The files of a class, with the roster and who in it handed them in, if there is one.

    Reads the roster, the teams, the list of who was late, and what lies where the table is to be
    written: the older table and the corrections. A ValueError says what is wrong in any of them.
    """

    def __init__(
        self,
        files: Sequence[HandedIn],
        roster: Path | None = None,
        late: Path | None = None,
        teams: Path | None = None,
        table: Path | None = None,
        lesson: str = "",
    ):
        self.files = files
        self.lesson = lesson
        self.path = table
        self.roster = read_roster(roster) if roster else EMPTY_ROSTER
        self.matching = match_students(files, self.roster) if roster else Matching()
        self.team_of = read_teams(teams, self.roster) if teams else {}
        self.late = self._late_files(late)
        self.old_marks: dict[str, dict[str, str]] = {}
        self.corrections: dict[str, list[Correction]] = {}
        self.without_student: list[Correction] = []
        if table:
            self.old_marks = read_marks(table)
            self._sort_corrections(read_corrections(table.parent))

    def student_of(self, file: HandedIn) -> str:
        """The name in the table of marks of who handed a file in."""
        return self.matching.row_of.get(file.student, file.student)

    def _late_files(self, late: Path | None) -> set[Path]:
        """The files that Canvas calls late, and those of students in the list of who was late."""
        lines = read_text(late)[0].splitlines() if late else []
        listed = {letters_and_digits(line) for line in lines} - {""}
        files = set()
        for file in self.files:
            names = {letters_and_digits(name) for name in (*file.names, self.student_of(file))}
            if file.is_late or names & listed:
                files.add(file.path)
        return files

    def _sort_corrections(self, corrections: Sequence[Correction]) -> None:
        """Sort corrections by the student's name in the table."""
        students = {*self.old_marks, *(self.student_of(file) for file in self.files)}
        for correction in corrections:
            student = correction.student
            if self.roster.students:
                try:
                    student = find_row(student, self.roster)
                except ValueError:
                    student = ""
            elif student not in students:
                student = ""
            if student:
                self.corrections.setdefault(student, []).append(correction)
            else:
                self.without_student.append(correction)

    @property
    def is_certain(self) -> bool:
        """Whether every file has a row, and every correction a student."""
        return not self.matching.candidates and not self.without_student

    def lines(self, reports: Sequence[FileReport]) -> Iterator[str]:
        """What a teacher has to look at, who was matched by what, and the points of each file."""
        for correction in self.without_student:
            named = f"{correction.student}, {correction.exercise}"
            yield f"NO STUDENT  {FILE}: {named}: nobody, or several, are called so"
        yield from self.matching.lines(self.roster.students, self.team_of)
        by_student = self.by_student(reports)
        table = self._make_table(by_student)
        for row in table.rows:
            for note in row.notes:
                yield f"NOT AS NOW  {row.student}: {note}"
        for student, files in by_student.items():
            for file in files:
                if file.faults and not file.reports:
                    yield f"NOT GRADED  {student}: {file.path.name}: {'; '.join(file.faults)}"
        for student, files in by_student.items():
            for file in files:
                if file.reports or not file.faults:
                    yield f"{student}: {file.path.name}: {file.points} of {file.possible} points"

    def by_student(self, reports: Sequence[FileReport | None]) -> dict[str, list[FileReport]]:
        """The reports on the files of each student, by name.

        `reports` has one for each file, None for those that are not graded yet. A file of a team
        is a file of each member.
        """
        reports_of = defaultdict(list)
        for file, report in zip(self.files, reports, strict=True):
            if report is None:
                continue
            student = self.student_of(file)
            for member in self.team_of.get(student, [student]):
                reports_of[member].append(report)
        return dict(sorted(reports_of.items()))

    def _make_table(self, reports_of: dict[str, list[FileReport]]) -> MarksTable:
        """The table of marks for the reports of each student."""
        return make_table(
            reports_of,
            self.roster.students,
            self.late,
            self.old_marks,
            self.corrections,
            self.lesson,
        )

    def keep_older_tables(self) -> None:
        """Keep the tables that will be replaced under names with a number."""
        if self.path:
            for path in (self.path, statistics_path(self.path), import_path(self.path)):
                keep_table(path)

    def write_marks(self, reports: Sequence[FileReport | None]) -> MarksTable | None:
        """Write the table of marks, also when some files are not graded yet."""
        if not self.path:
            return None
        reports_of = self.by_student(reports)
        waiting = self._waiting(reports)
        for student in waiting:
            reports_of.setdefault(student, [])
        table = self._make_table(reports_of)
        for row in table.rows:
            if row.student in {csv_cell(student) for student in waiting}:
                row.problems = ["not graded yet"]
        table.write(self.path)
        return table

    def _waiting(self, reports: Sequence[FileReport | None]) -> set[str]:
        """The students with a file that is not graded yet."""
        students: set[str] = set()
        for file, report in zip(self.files, reports, strict=True):
            if report is None:
                student = self.student_of(file)
                students.update(self.team_of.get(student, [student]))
        return students

    def write_tables(self, reports: Sequence[FileReport]) -> list[str]:
        """Write the table of marks, the statistics beside it and, with a roster, the import.

        Exercises that are not handed in now keep their marks of the older table, and what is no
        number, such as "excused", is kept. Returns what there is to say about the import. Raises a
        ValueError in place of the import if most submissions or most rows have no match.
        """
        table = self.write_marks(reports)
        if table is None or not self.path:
            return []
        best = [best_reports(files) for files in self.by_student(reports).values()]
        write_statistics(statistics_path(self.path), best)
        if not self.roster.students:
            return []
        return self._write_import(import_path(self.path), table, reports)

    def _write_import(
        self, path: Path, table: MarksTable, reports: Sequence[FileReport]
    ) -> list[str]:
        """Write the roster with the points of each lesson; return notes on its columns."""
        rows = {row.student: row for row in table.rows}
        row_of = {student: rows[csv_cell(student)] for student in self.roster.students}
        strangers = len(self.matching.candidates)
        empty = 0
        for student, row in row_of.items():
            if row.problems == [NOTHING_HANDED_IN] and not self.matching.claimants(student):
                empty += 1
        if strangers > len(self.matching.row_of):
            raise ValueError(f"{path} is not written: {strangers} students have no row (above)")
        if 2 * empty > len(row_of):
            raise ValueError(f"{path} is not written: {empty} rows of the roster have no marks")
        try:
            columns = find_columns(self.roster, table.lessons, _lessons_of(table, reports))
        except ValueError as error:
            raise ValueError(f"{path} is not written: {error}") from None
        write_import(path, self.roster, table, row_of, columns, self._uncertain(row_of, reports))
        return list(import_notes(columns, table))

    def _uncertain(self, row_of: dict[str, Row], reports: Sequence[FileReport]) -> set[str]:
        """The rows whose missing marks are not 0: a file that is not graded may be theirs."""
        uncertain = {row for row in row_of if self.matching.claimants(row)}
        for student, files in self.by_student(reports).items():
            if any(file.faults and not file.reports for file in files):
                uncertain.add(student)
        return uncertain


def statistics_path(table: Path) -> Path:
    """The file of the statistics beside a table of marks."""
    return table.with_stem(f"{table.stem}_statistics")


def import_path(table: Path) -> Path:
    """The file of the import beside a table of marks."""
    return table.with_stem(f"{table.stem}_import")


def _lessons_of(table: MarksTable, reports: Sequence[FileReport]) -> list[str]:
    """The lessons of a table that were handed in now."""
    graded: set[str] = set()
    for file in reports:
        graded.update(report.operation for report in file.reports)
    return [lesson for lesson in table.lessons if not graded.isdisjoint(ASSIGNMENTS[lesson])]
