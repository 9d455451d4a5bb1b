"""Tables of a class: marks, a file that Moodle and Canvas import, and which properties failed."""

import math
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from shutil import copyfile

from numpy_cae.course.catalogue import ASSIGNMENTS, CATALOGUE
from numpy_cae.course.marks.roster import CANVAS, POSSIBLE, Roster, read_roster
from numpy_cae.verify.grading.report import Report
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import csv_cell

MAXIMUM = "maximum"
NOTHING = "nothing handed in"
MARKS = Roster((), {}, (), "utf-8", ",")
"""MARKS: the form in which tables are written."""
Row = dict[str, str | int | float]
Reports = Mapping[str, Sequence[FileReport]]


def write_tables(
    path: Path, by_student: Reports, roster: Roster | None = None, late: Collection[Path] = ()
) -> list[Row]:
    """Write the marks and the statistics beside them; returns the rows of the marks.

    The table has a row for everyone in the roster and everyone who handed something in. Of an
    exercise handed in more than once the best counts. Where the table exists, exercises that are
    not handed in now keep their marks, and what is no number, such as "excused", is kept; the old
    table is kept under a name with a number.
    """
    before = read_roster(path).students if path.exists() else {}
    before.pop(MAXIMUM, None)
    files = {csv_cell(student): each for student, each in by_student.items()}
    in_roster = [csv_cell(student) for student in roster.students] if roster else []
    reports = {student: best(each) for student, each in files.items()}
    names = _graded_names(before, reports)
    lessons = {n: each for n, each in ASSIGNMENTS.items() if set(each) & set(names)}
    table = [_row(MAXIMUM, {name: CATALOGUE[name].points for name in names}, lessons)]
    for student in dict.fromkeys([*in_roster, *files, *before]):
        marks = _marks(names, reports.get(student, {}), before.get(student, {}))
        row = _row(student, marks, lessons)
        excused = sum(CATALOGUE[n].points for n in names if row[n] and _number(row[n]) is None)
        problems = list(_problems(row, files.get(student, ()), late))
        problems += ["not in the roster"] * bool(roster and student not in in_roster)
        row["possible"] = table[0]["total"] - excused
        row["percent"] = round(100 * row["total"] / max(1, row["possible"]), 1)
        row["problems"] = csv_cell("; ".join(problems))
        table.append(row)
    if path.exists():
        numbered = (path.with_suffix(f".{n}{path.suffix}") for n in range(1, 10_000))
        copyfile(path, next(free for free in numbered if not free.exists()))
    MARKS.write(path, table)
    statistics = _statistics(list(reports.values()))
    MARKS.write(path.with_stem(f"{path.stem}_statistics"), statistics)
    return table


def write_import(path: Path, roster: Roster, table: Sequence[Row]) -> None:
    """Write the roster with the points of each lesson; an empty cell counts 0 there."""
    marks = {row["student"]: row for row in table}
    lessons = [name for name in table[0] if str(name).startswith("lesson ")]

    def with_points(row: dict[str, str], student: str) -> dict[str, str]:
        given = marks[csv_cell(student)]
        return row | {name.capitalize(): str(given[name] or 0) for name in lessons}

    first = roster.columns[0]
    others = [with_points(row, MAXIMUM) if POSSIBLE in row[first] else row for row in roster.others]
    if CANVAS in roster.columns and not any(POSSIBLE in row[first] for row in others):
        empty = dict.fromkeys(roster.columns, "")
        others.insert(0, with_points(empty | {first: POSSIBLE}, MAXIMUM))
    roster.write(path, [*others, *(with_points(row, key) for key, row in roster.students.items())])


def _graded_names(before: Mapping[str, dict], reports: Mapping[str, dict]) -> list[str]:
    """The exercises with a mark, now or before, those of lessons first; a lesson is complete."""
    marked = {name for row in before.values() for name in row if name in CATALOGUE and row[name]}
    marked |= {name for of_one in reports.values() for name in of_one}
    of_lessons = [n for names in ASSIGNMENTS.values() if marked & set(names) for n in names]
    return [*of_lessons, *(n for n in CATALOGUE if n in marked and n not in of_lessons)]


def _marks(names: Sequence[str], new: Mapping[str, Report], old: Mapping[str, str]) -> dict:
    """The points of each exercise: those of now, unless the table has a text for it."""
    return {
        n: new[n].points if n in new and _number(old.get(n, "")) is not None else old.get(n) or ""
        for n in names
    }


def _problems(row: Row, files: Sequence[FileReport], late: Collection[Path]) -> Iterator[str]:
    if not files and not any(mark for column, mark in row.items() if column != "student"):
        yield NOTHING
        return
    for each in files:
        yield from each.faults
        yield from (f"the cell of {name} is there twice" for name in each.copied)
        if each.reports and not each.points and not each.faults:
            yield f"{each.path.name} has no points"
    for name, value in row.items():
        if value == "" and name.startswith("lesson"):
            yield f"{name} missing"
    for each in files:
        if each.path in late:
            yield f"{each.path.name} late"


def _number(text: str | float) -> int | None:
    """The points in a cell, 0 where it is empty, None where it is no number."""
    try:
        value = float(text or 0)
    except ValueError:
        return None
    return int(value) if math.isfinite(value) else None


def best(files: Sequence[FileReport]) -> dict[str, Report]:
    """The report with most points on each exercise of a student."""
    found: dict[str, Report] = {}
    for report in (report for each in files for report in each.reports):
        other = found.setdefault(report.operation, report)
        found[report.operation] = max(other, report, key=lambda each: each.points)
    return found


def _row(student: str, points: dict, lessons: Mapping[str, Sequence[str]]) -> Row:
    """The points of each exercise and each lesson, and their sum."""
    row: Row = {"student": student, **points}
    for n, names in lessons.items():
        cells = [points[name] for name in names if points.get(name, "") != ""]
        numbers = [_number(cell) for cell in cells if _number(cell) is not None]
        row[f"lesson {n}"] = sum(numbers) if numbers else "".join(map(str, cells[:1]))
    row["total"] = sum(_number(cell) or 0 for cell in points.values())
    return row


def _statistics(reports: Sequence[Mapping[str, Report]]) -> list[dict]:
    """For each exercise how many handed it in, their mean, and how often each property failed."""
    rows = []
    for name in CATALOGUE:
        of_exercise = [each[name] for each in reports if name in each]
        failed = Counter(o.stated.name for each in of_exercise for o in each.failing())
        for stated in CATALOGUE[name].properties if of_exercise else ():
            mean = sum(each.points for each in of_exercise) / len(of_exercise)
            row = {"exercise": name, "handed in": len(of_exercise), "mean points": round(mean, 1)}
            row |= {"possible": CATALOGUE[name].points, "property": stated.name}
            rows.append(row | {"failed": failed[stated.name]})
    return sorted(rows, key=lambda row: -row["failed"])
