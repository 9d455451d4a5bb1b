"""The table of marks: a row for each student, and how the table is written and read back.

A row is made of the reports on a student's files and of the marks that an older table has. The
headings of the columns ("lesson 03", "total", "possible") are made when the table is written.
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from shutil import copyfile

from numpy_cae.course.catalogue import ASSIGNMENTS, CATALOGUE
from numpy_cae.course.marks.roster import EMPTY_ROSTER, Cells, read_roster
from numpy_cae.verify.grading.report import Report
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import csv_cell

MAXIMUM = "maximum"
"""In the table, the name of the row with the points that are possible."""
NOTHING_HANDED_IN = "nothing handed in"

Mark = int | str
"""The points of an exercise, or the text that stands for them in an older table."""


@dataclass
class Row:
    """The marks of a student.

    Attributes
    ----------
    student : str
        The name as the table has it.
    points : dict of str to int or str
        The mark of each exercise that has one. A text is that of an older table: a number, or a
        word such as "excused", which is not counted.
    problems : list of str
        What is wrong with the student's files, and which lessons are missing.
    """

    student: str
    points: dict[str, Mark]
    problems: list[str] = field(default_factory=list)

    def lesson_mark(self, lesson: str) -> Mark:
        """The sum of a lesson's points; the word where it has no number; "" without a mark."""
        marks = [self.points[name] for name in ASSIGNMENTS[lesson] if name in self.points]
        numbers = [number for mark in marks if (number := as_points(mark)) is not None]
        if numbers:
            return sum(numbers)
        return marks[0] if marks else ""

    def total(self) -> int:
        """The sum of all points."""
        return sum(as_points(mark) or 0 for mark in self.points.values())

    def excused(self) -> list[str]:
        """The exercises that have a word in place of points."""
        return [name for name, mark in self.points.items() if as_points(mark) is None]


def as_points(mark: Mark) -> int | None:
    """A mark as a number of points, None where it is a word."""
    try:
        value = float(mark)
    except ValueError:
        return None
    return int(value) if math.isfinite(value) else None


@dataclass(frozen=True)
class MarksTable:
    """The marks of a class: its exercises in the order of the columns, and a row a student."""

    exercises: list[str]
    rows: list[Row]

    @property
    def lessons(self) -> list[str]:
        """The numbers of the lessons whose exercises the table has."""
        return [number for number, names in ASSIGNMENTS.items() if set(names) & {*self.exercises}]

    def maximum(self) -> Row:
        """The points that each exercise can have."""
        return Row(MAXIMUM, {name: CATALOGUE[name].points for name in self.exercises})

    def write(self, path: Path) -> None:
        """Write the table; one that exists is kept under a name with a number."""
        if path.exists():
            copyfile(path, _free_path(path))
        maximum = self.maximum()
        possible = maximum.total()
        lines = [self._cells(maximum), *(self._all_cells(row, possible) for row in self.rows)]
        EMPTY_ROSTER.write(path, lines)

    def _cells(self, row: Row) -> Cells:
        """The cells of a row: points of exercises, of lessons, and the total."""
        cells = {"student": row.student}
        cells |= {name: str(row.points.get(name, "")) for name in self.exercises}
        cells |= {f"lesson {number}": str(row.lesson_mark(number)) for number in self.lessons}
        return {**cells, "total": str(row.total())}

    def _all_cells(self, row: Row, possible: int) -> Cells:
        """The cells of a student's row: as above, and what the total is counted of, and why."""
        possible -= sum(CATALOGUE[name].points for name in row.excused())
        percent = round(100 * row.total() / max(1, possible), 1)
        problems = csv_cell("; ".join(row.problems))
        counted = {"possible": str(possible), "percent": str(percent), "problems": problems}
        return self._cells(row) | counted

    def lesson_points(self, row: Row) -> Cells:
        """The points of each lesson as an import has them; no mark counts 0 there."""
        return {f"Lesson {number}": str(row.lesson_mark(number) or 0) for number in self.lessons}


def _free_path(path: Path) -> Path:
    """The path with the first number that no file has."""
    for number in range(1, 10_000):
        numbered = path.with_suffix(f".{number}{path.suffix}")
        if not numbered.exists():
            return numbered
    raise FileExistsError(f"{path}: there are ten thousand older tables beside it: delete some")


def read_marks(path: Path) -> dict[str, dict[str, str]]:
    """The marks of an older table by student and exercise; none if there is no such file."""
    if not path.exists():
        return {}
    students = read_roster(path).students
    return {
        student: {name: mark for name, mark in cells.items() if name in CATALOGUE and mark}
        for student, cells in students.items()
        if student != MAXIMUM
    }


def make_table(
    reports_of: Mapping[str, Sequence[FileReport]],
    roster: Collection[str],
    late: Collection[Path],
    old_marks: Mapping[str, Mapping[str, str]],
) -> MarksTable:
    """The table of a class.

    Parameters
    ----------
    reports_of : dict of str to list of FileReport
        The reports on each student's files. Of an exercise handed in more than once the best
        counts.
    roster : collection of str
        The students of the class, who have a row in any case.
    late : collection of Path
        The files that came late.
    old_marks : dict of str to dict of str to str
        The marks by student and exercise of the table that is replaced. They stay for exercises
        that are not handed in now, and where they are no number, such as "excused".
    """
    reports_of = {csv_cell(student): files for student, files in reports_of.items()}
    best = {student: best_reports(files) for student, files in reports_of.items()}
    exercises = _exercises_with_marks([*best.values(), *old_marks.values()])
    in_roster = [csv_cell(student) for student in roster]
    table = MarksTable(exercises, [])
    for student in dict.fromkeys([*in_roster, *reports_of, *old_marks]):
        row = Row(student, _marks(best.get(student, {}), old_marks.get(student, {})))
        row.problems += _problems(row, reports_of.get(student, ()), late, table.lessons)
        if in_roster and student not in in_roster:
            row.problems.append("not in the roster")
        table.rows.append(row)
    return table


def best_reports(files: Sequence[FileReport]) -> dict[str, Report]:
    """The report with most points on each exercise of a student, the first one of several."""
    best: dict[str, Report] = {}
    for file in files:
        for report in file.reports:
            name = report.operation
            if name not in best or report.points > best[name].points:
                best[name] = report
    return best


def _exercises_with_marks(marks: Sequence[Mapping[str, object]]) -> list[str]:
    """The exercises with a mark, those of lessons first; of a lesson, all of its exercises."""
    names = {name for of_student in marks for name in of_student}
    exercises: list[str] = []
    for assigned in ASSIGNMENTS.values():
        if names & set(assigned):
            exercises += assigned
    return [*exercises, *(name for name in CATALOGUE if name in names and name not in exercises)]


def _marks(reports: Mapping[str, Report], old_marks: Mapping[str, str]) -> dict[str, Mark]:
    """The mark of each exercise: its points, unless the older table has a word in their place."""
    marks: dict[str, Mark] = dict(old_marks)
    for name, report in reports.items():
        if as_points(marks.get(name, 0)) is not None:
            marks[name] = report.points
    return marks


def _problems(
    row: Row, files: Sequence[FileReport], late: Collection[Path], lessons: Sequence[str]
) -> Iterator[str]:
    """What is wrong with a student's files, and which of the lessons are missing."""
    if not files and not row.points:
        yield NOTHING_HANDED_IN
        return
    for file in files:
        yield from file.faults
        for name in file.copied:
            yield f"the cell of {name} is there twice"
        if file.reports and not file.points and not file.faults:
            yield f"{file.path.name} has no points"
    for number in lessons:
        if row.lesson_mark(number) == "":
            yield f"lesson {number} missing"
    for file in files:
        if file.path in late:
            yield f"{file.path.name} late"
