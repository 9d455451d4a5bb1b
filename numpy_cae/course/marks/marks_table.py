"""The table of marks: a row for each student, and how the table is written and read back.

A row is made of the reports on a student's files and of the marks that an older table has. The
headings of the columns ("lesson 03", "total", "possible") are made when the table is written.
"""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from shutil import copy2

from numpy_cae.atomic_write import require_place
from numpy_cae.course.catalogue import ASSIGNMENTS, CATALOGUE
from numpy_cae.course.marks.corrections import Correction
from numpy_cae.course.marks.roster import EMPTY_ROSTER, Cells, read_roster
from numpy_cae.verify.grading.report import Report
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import csv_cell

MAXIMUM = "maximum"
"""In the table, the name of the row with the points that are possible."""
NOTHING_HANDED_IN = "nothing handed in"
FEWEST = 0.25
"""A lesson counts if at least this share of the students with marks has a mark of it."""

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
    notes : list of str
        Which marks are not those of the files that are graded now, and why.
    """

    student: str
    points: dict[str, Mark]
    problems: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

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
        """Write the table."""
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
        problems = csv_cell("; ".join([*row.problems, *row.notes]))
        counted = {"possible": str(possible), "percent": str(percent), "problems": problems}
        return self._cells(row) | counted


def keep_table(path: Path) -> None:
    """Copy a table that exists, with its mode, to a name with a number."""
    require_place(path)
    if path.exists():
        copy2(path, _free_path(path))


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
    corrections: Mapping[str, Sequence[Correction]],
    one_lesson: str = "",
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
        that are not handed in now, where they are no number, such as "excused", and where they are
        better than those of now.
    corrections : dict of str to list of Correction
        What counts in place of any other mark, by student.
    one_lesson : str
        The lesson that every file is graded for, or "".
    """
    reports_of = {csv_cell(student): files for student, files in reports_of.items()}
    corrections = {csv_cell(student): listed for student, listed in corrections.items()}
    best = {student: best_reports(files) for student, files in reports_of.items()}
    before = _names_in([*old_marks.values(), *map(_names_corrected, corrections.values())])
    uncounted: set[str] = set()
    if not one_lesson:
        uncounted = _odd_exercises([*_marks_of_students(best, old_marks).values()], before)
    in_roster = [csv_cell(student) for student in roster]
    exercises = _exercises_with_marks((_names_in(best.values()) | before) - uncounted)
    table = MarksTable(exercises, [])
    for student in dict.fromkeys([*in_roster, *reports_of, *old_marks, *corrections]):
        marks, notes = _marks(
            best.get(student, {}), old_marks.get(student, {}), corrections.get(student, ())
        )
        row = Row(student, {}, notes=notes)
        for name, mark in marks.items():
            if name not in uncounted:
                row.points[name] = mark
        row.problems += _problems(row, reports_of.get(student, ()), late, table.lessons, uncounted)
        if in_roster and student not in in_roster:
            row.problems.append("not in the roster")
        table.rows.append(row)
    return table


def _marks_of_students(
    best: Mapping[str, Mapping[str, Report]], old_marks: Mapping[str, Mapping[str, str]]
) -> dict[str, set[str]]:
    """The exercises that each student has a mark of, now or in the older table."""
    names: dict[str, set[str]] = {}
    for student in best.keys() | old_marks.keys():
        names[student] = {*best.get(student, {}), *old_marks.get(student, {})}
    return names


def _odd_exercises(names_of_students: Sequence[set[str]], counted: Collection[str]) -> set[str]:
    """The exercises of lessons that so few students handed in that it was by mistake.

    Only the exercises of lessons that are not odd have columns, so that two files of another lesson
    change nobody's maximum. A lesson of which an exercise is counted already is not odd.
    """
    with_marks = [names for names in names_of_students if names]
    odd: set[str] = set()
    for assigned in ASSIGNMENTS.values():
        count = sum(1 for names in with_marks if not names.isdisjoint(assigned))
        is_counted = not set(assigned).isdisjoint(counted)
        if 0 < count < FEWEST * len(with_marks) and not is_counted:
            odd.update(assigned)
    return odd


def _names_in(marks: Iterable[Iterable[str]]) -> set[str]:
    """The names of all exercises that have a mark."""
    names: set[str] = set()
    for of_student in marks:
        names.update(of_student)
    return names


def _names_corrected(corrections: Sequence[Correction]) -> list[str]:
    """The exercises of some corrections."""
    return [correction.exercise for correction in corrections]


def best_reports(files: Sequence[FileReport]) -> dict[str, Report]:
    """The report with most points on each exercise of a student, the first one of several."""
    best: dict[str, Report] = {}
    for file in files:
        for report in file.reports:
            name = report.operation
            if name not in best or report.points > best[name].points:
                best[name] = report
    return best


def _exercises_with_marks(names: Collection[str]) -> list[str]:
    """The exercises with a mark, those of lessons first; of a lesson, all of its exercises."""
    exercises: list[str] = []
    for assigned in ASSIGNMENTS.values():
        if not set(assigned).isdisjoint(names):
            exercises += assigned
    return [*exercises, *(name for name in CATALOGUE if name in names and name not in exercises)]


def _marks(
    reports: Mapping[str, Report],
    old_marks: Mapping[str, str],
    corrections: Sequence[Correction],
) -> tuple[dict[str, Mark], list[str]]:
    """The mark of each exercise, and notes on those that are not the points of now.

    A correction counts, else the older table's word, else the better number of now and before.
    """
    marks: dict[str, Mark] = dict(old_marks)
    notes = []
    for name, report in reports.items():
        before = as_points(marks.get(name, 0))
        if before is None:
            continue
        marks[name] = max(report.points, before)
        if before > report.points:
            notes.append(f"{name}: {before} points of an earlier run count, not {report.points}")
    for correction in corrections:
        name = correction.exercise
        replaced = reports[name].points if name in reports else marks.get(name, "no mark")
        marks[name] = correction.points
        notes.append(
            f"{name}: corrected to {correction.points} from {replaced} ({correction.reason})"
        )
    return marks, notes


def _problems(
    row: Row,
    files: Sequence[FileReport],
    late: Collection[Path],
    lessons: Sequence[str],
    uncounted: Collection[str],
) -> Iterator[str]:
    """What is wrong with a student's files, and which of the lessons are missing."""
    if not files and not row.points:
        yield NOTHING_HANDED_IN
        return
    for file in files:
        yield from file.faults
        if file.ungraded:
            yield f"{file.path.name} is NOT GRADED, {file.ungraded}: grade it again"
        for name in file.copied:
            yield f"the cell of {name} is there twice"
        if file.reports and not file.points and not file.faults:
            yield f"{file.path.name} has no points"
        if any(report.operation in uncounted for report in file.reports):
            yield f"{file.path.name} is not counted: few handed its lesson in"
    for number in lessons:
        if row.lesson_mark(number) == "":
            yield f"lesson {number} missing"
    for file in files:
        if file.path in late:
            yield f"{file.path.name} late"
