"""The file to import: the roster in its own form, with the points of each lesson.

Moodle's grading worksheet has a column for the grade of its assignment, and Canvas's gradebook a
column for each assignment, such as "Lesson 03 (8811)". These are filled. Any other table gets a
column "Lesson 03" for each lesson.
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from numpy_cae.course.marks.marks_table import MarksTable, Row, as_points
from numpy_cae.course.marks.roster import OF_CANVAS, POSSIBLE, Cells, Roster

OF_ASSIGNMENT = re.compile(r"(?P<title>.*\S) \((?P<number>\d+)\)")
"""The heading of Canvas's column of an assignment."""
PARTICIPANT = re.compile(r"(?P<text>\D+)(?P<number>\d+)")
"""What the first column of a worksheet has: the word for "Participant", and a number."""
EXCUSED = "excused"
CANVAS_EXCUSED = "EX"
"""What Canvas reads as an excused student."""


@dataclass(frozen=True)
class GradeColumn:
    """A column that gets the points of a lesson; `maximum` is what the system has as possible.

    `maximum` is None where the points are written as they are.
    """

    name: str
    maximum: float | None
    has_comma: bool = False

    def grade(self, points: int, possible: int) -> str:
        """The grade for points of so many that are possible."""
        grade = float(points)
        if self.maximum is not None and possible:
            grade = points * self.maximum / possible
        text = f"{grade:.2f}".rstrip("0").rstrip(".")
        return text.replace(".", ",") if self.has_comma else text


def find_columns(
    roster: Roster, lessons: Sequence[str], graded_now: Sequence[str]
) -> dict[str, GradeColumn]:
    """The column of each lesson.

    A worksheet has one, for the lesson that is graded now; a ValueError says that there are
    several.
    """
    worksheet = _find_worksheet_column(roster)
    if worksheet is not None:
        if len(graded_now) > 1:
            several = ", ".join(graded_now)
            raise ValueError(
                f"a grading worksheet is of one assignment, and there are lessons {several}: "
                "name the lesson with --lesson"
            )
        return {lesson: worksheet for lesson in graded_now}
    columns = {}
    for lesson in lessons:
        columns[lesson] = _find_canvas_column(roster, lesson) or GradeColumn(
            f"Lesson {lesson}", None
        )
    return columns


def _find_worksheet_column(roster: Roster) -> GradeColumn | None:
    """The column "Grade" of Moodle's grading worksheet, in any language; None in other tables.

    The first column has the same word and a number in each row, and the column behind the grade has
    the same positive number in all rows.
    """
    rows = list(roster.students.values())
    if not roster.columns:
        return None
    participants = [PARTICIPANT.fullmatch(row[roster.columns[0]].strip()) for row in rows]
    words = {match["text"] if match else "" for match in participants}
    if len(words) != 1 or "" in words:
        return None
    for place in reversed(range(2, len(roster.columns))):
        column = roster.columns[place]
        cells = {row[column].strip() for row in rows}
        maximum = _number(cells.pop()) if len(cells) == 1 else None
        grade = roster.columns[place - 1]
        if maximum and all(_is_grade(row[grade]) for row in rows):
            return GradeColumn(grade, maximum, "," in rows[0][column])
    return None


def _is_grade(cell: str) -> bool:
    return not cell.strip() or _number(cell) is not None


def _number(cell: str) -> float | None:
    """A positive number in a cell, with a point or a comma; None for anything else."""
    try:
        number = float(cell.strip().replace(",", "."))
    except ValueError:
        return None
    return number if 0 <= number < float("inf") else None


def _find_canvas_column(roster: Roster, lesson: str) -> GradeColumn | None:
    """The column of the assignment whose title has the words "Lesson 03"; None if there is none."""
    if OF_CANVAS not in roster.columns:
        return None
    for column in roster.columns:
        match = OF_ASSIGNMENT.fullmatch(column)
        if match and re.search(rf"\blesson\W*{lesson}\b", match["title"], re.IGNORECASE):
            maximum = None
            for row in roster.other_rows:
                if POSSIBLE in row[roster.columns[0]]:
                    maximum = _number(row[column])
            return GradeColumn(column, maximum or None)
    return None


def import_notes(columns: Mapping[str, GradeColumn], table: MarksTable) -> Iterator[str]:
    """What is to be known about the columns: which are filled, and where points are scaled."""
    possible = table.maximum()
    for lesson, column in columns.items():
        points = as_points(possible.lesson_mark(lesson)) or 0
        if column.maximum not in (None, points):
            scaled = f"{points} points of lesson {lesson} are {column.maximum:g} there"
            yield f"IMPORT      column {column.name!r}: {scaled}"
        else:
            yield f"IMPORT      column {column.name!r}: the points of lesson {lesson}, of {points}"


def write_import(
    path: Path,
    roster: Roster,
    table: MarksTable,
    row_of: Mapping[str, Row],
    columns: Mapping[str, GradeColumn],
    uncertain: Collection[str],
) -> None:
    """Write the roster with the points of each lesson.

    Parameters
    ----------
    path : Path
    roster : Roster
    table : MarksTable
    row_of : dict of str to Row
        The marks of each row of the roster.
    columns : dict of str to GradeColumn
        The column of each lesson.
    uncertain : collection of str
        The rows whose missing marks are not 0, since a file that was not graded or has no row may
        be theirs. There the cell stays as it is in the roster.
    """
    is_canvas = OF_CANVAS in roster.columns
    maximum = table.maximum()
    rows = _other_rows(roster, maximum, columns)
    for student, cells in roster.students.items():
        filled = dict(cells)
        for lesson, column in columns.items():
            mark = row_of[student].lesson_mark(lesson)
            possible = as_points(maximum.lesson_mark(lesson)) or 0
            grade = _grade(mark, column, possible, is_canvas, student in uncertain)
            filled[column.name] = cells.get(column.name, "") if grade is None else grade
        rows.append(filled)
    roster.write(path, rows)


def _grade(
    mark: int | str, column: GradeColumn, possible: int, is_canvas: bool, is_uncertain: bool
) -> str | None:
    """What a cell gets for a mark; None where it stays as it is."""
    if mark == "":
        return None if is_uncertain else column.grade(0, possible)
    points = as_points(mark)
    if points is not None:
        return column.grade(points, possible)
    if is_canvas and mark == EXCUSED:
        return CANVAS_EXCUSED
    if column.maximum is None:
        return str(mark)
    return None


def _other_rows(roster: Roster, maximum: Row, columns: Mapping[str, GradeColumn]) -> list[Cells]:
    """The rows of no student, with the points that are possible in the columns that are added."""
    added = {
        column.name: str(maximum.lesson_mark(lesson))
        for lesson, column in columns.items()
        if column.name not in roster.columns
    }
    if not roster.columns:
        return []
    first = roster.columns[0]
    rows = [row | added if POSSIBLE in row[first] else row for row in roster.other_rows]
    if OF_CANVAS in roster.columns and not any(POSSIBLE in row[first] for row in rows):
        rows.insert(0, dict.fromkeys(roster.columns, "") | {first: POSSIBLE} | added)
    return rows
