"""The marks of a class: tables of them, a file that Moodle and Canvas import, and feedback.

Pairs of submissions that are alike after renaming are listed as a sign to look at them.
"""

import ast
import math
import os
import re
import textwrap
from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from shutil import copyfile

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.catalogue import ASSIGNMENTS, CATALOGUE
from numpy_cae.course.marks.handed_in import HandedIn
from numpy_cae.course.marks.roster import Roster, decoded, match, read_roster, squashed
from numpy_cae.verify.grading.report import Report
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.verify.grading.submission import Submission, read_submission
from numpy_cae.visible import csv_cell, visible

LONGEST_NAME = 50
"""LONGEST_NAME: a file of feedback has so many characters of the student's name; a character may
take four bytes, and systems allow 255 in a name."""
INDENT = " " * 4  # a block of code in Markdown, whose text does nothing else
MAXIMUM = "maximum"
NOTHING = "nothing handed in"
NOBODY = Roster((), {}, (), "utf-8", ",")
"""NOBODY: a roster without students, and the form in which tables are written."""
LONG = 6
"""LONG: runs of so many parts of the syntax are compared."""
LEAST_SHARE = 0.6
"""LEAST_SHARE: a pair is listed if it shares this part of what is not common to the class."""
LEAST_RUNS = 20
"""LEAST_RUNS: a pair with less to compare is not listed: a short answer has few forms."""
COMMON = 0.1
"""COMMON: a run in more than this part of the submissions, and in more than `FEW`, is common."""
FEW = 4
Row = dict[str, str | int | float]
Reports = Mapping[str, Sequence[FileReport]]
"""The reports on the files of each student, by name."""


class ClassMarks:
    """The files of a class, with the roster and who in it handed them in, if there is one.

    Reads the roster and the list of who was late; a ValueError says what is wrong.
    """

    def __init__(self, files: Sequence[HandedIn], roster: Path | None, late: Path | None):
        self.files = files
        self.roster = read_roster(roster) if roster else NOBODY
        self.key_of, self.matching = match(files, self.roster) if roster else ({}, [])
        listed = decoded(late.read_bytes())[0].splitlines() if late else []
        names = {squashed(line) for line in listed} - {""}
        self.late = {
            each.path
            for each in files
            if each.is_late or names & {squashed(n) for n in (*each.called, self.key(each))}
        }

    def key(self, file: HandedIn) -> str:
        """The name in the table of marks of who handed a file in."""
        return self.key_of.get(file.student, file.student)

    def lines(self, graded: Sequence[FileReport]) -> Iterator[str]:
        """Who was matched by what, and the points of each file."""
        yield from self.matching
        for student, reports in self.by_student(graded).items():
            for each in reports:
                yield f"{student}: {each.path.name}: {each.points} of {each.possible} points"

    def similar(self) -> Iterator[str]:
        """The pairs of students whose files are alike."""
        submissions = defaultdict(list)
        for each in self.files:
            submissions[self.key(each)].append(read_submission(each.path))
        yield "alike after renaming, as a sign to look and not as a verdict:"
        for share, one, other in similar_pairs(submissions):
            yield f"  {share:4.0%}  {one}  {other}"

    def write_tables(self, path: Path, graded: Sequence[FileReport]) -> None:
        """Write the table of marks and, with a roster, the file to import.

        Raises a ValueError in place of that file if most submissions or most rows have no match.
        """
        table = write_tables(path, self.by_student(graded), self.roster, self.late)
        imported = path.with_stem(f"{path.stem}_import")
        students = self.roster.students
        strangers = len({each.student for each in self.files} - self.key_of.keys())
        without = {row["student"] for row in table if row.get("problems") == NOTHING}
        empty = sum(csv_cell(student) in without for student in students)
        if students and strangers > len(self.key_of):
            raise ValueError(f"{imported} is not written: {strangers} students have no row (above)")
        if 2 * empty > len(students):
            raise ValueError(f"{imported} is not written: {empty} rows of the roster have no marks")
        lessons = [name for name in table[0] if name.startswith("lesson ")]

        def points_of(row: Row) -> dict[str, str]:
            return {name.capitalize(): str(row[name] or 0) for name in lessons}

        marks = {row["student"]: points_of(row) for row in table}
        points = {student: marks[csv_cell(student)] for student in students}
        if students:  # an empty cell counts 0 there
            self.roster.write_with(imported, points, marks[MAXIMUM])

    def by_student(self, graded: Sequence[FileReport]) -> dict[str, list[FileReport]]:
        """The reports on the files of each student, by name."""
        found = defaultdict(list)
        for each, report in zip(self.files, graded, strict=True):
            found[self.key(each)].append(report)
        return dict(sorted(found.items()))


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


def write_tables(
    path: Path, by_student: Reports, roster: Roster = NOBODY, late: Collection[Path] = ()
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
    in_roster = [csv_cell(student) for student in roster.students]
    reports = {student: best(each) for student, each in files.items()}
    names = _graded_names(before, reports)
    lessons = {n: each for n, each in ASSIGNMENTS.items() if set(each) & set(names)}
    table = [_row(MAXIMUM, {name: CATALOGUE[name].points for name in names}, lessons)]
    for student in dict.fromkeys([*in_roster, *files, *before]):
        marks = _marks(names, reports.get(student, {}), before.get(student, {}))
        row = _row(student, marks, lessons)
        excused = sum(CATALOGUE[n].points for n in names if row[n] and _number(row[n]) is None)
        problems = list(_problems(row, files.get(student, ()), late))
        problems += ["not in the roster"] * bool(in_roster and student not in in_roster)
        row["possible"] = table[0]["total"] - excused
        row["percent"] = round(100 * row["total"] / max(1, row["possible"]), 1)
        row["problems"] = csv_cell("; ".join(problems))
        table.append(row)
    if path.exists():
        numbered = (path.with_suffix(f".{n}{path.suffix}") for n in range(1, 10_000))
        copyfile(path, next(free for free in numbered if not free.exists()))
    NOBODY.write(path, table)
    statistics = _statistics(list(reports.values()))
    NOBODY.write(path.with_stem(f"{path.stem}_statistics"), statistics)
    return table


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
    """The report with most points on each exercise of a student, the first one of several."""
    reports = [report for each in files for report in each.reports]
    return {each.operation: each for each in sorted(reports[::-1], key=lambda each: each.points)}


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


def similar_pairs(submissions: Mapping[str, Sequence[Submission]]) -> list[tuple[float, str, str]]:
    """The pairs of students whose functions are alike, each with the share, most alike first.

    Names, comments, docstrings, numbers and the layout do not count.
    """
    runs = {student: set(_runs(files)) for student, files in submissions.items()}
    counts = Counter(run for each in runs.values() for run in each)
    most = max(FEW, COMMON * len(runs))
    rare = {student: {r for r in each if counts[r] <= most} for student, each in runs.items()}
    pairs = []
    for one, other in combinations(rare, 2):
        union = len(rare[one] | rare[other])
        share = len(rare[one] & rare[other]) / max(union, LEAST_RUNS)
        if share >= LEAST_SHARE:
            pairs.append((share, one, other))
    return sorted(pairs, reverse=True)


def _runs(files: Sequence[Submission]) -> Iterator[tuple[str, ...]]:
    for file in files:
        for _, source in file.cells:
            try:
                tree = ast.parse(source)
            except (SyntaxError, ValueError, RecursionError, MemoryError):
                continue
            for function in ast.walk(tree):
                if isinstance(function, ast.FunctionDef):
                    parts = list(_parts(function))
                    yield from zip(*(parts[n:] for n in range(LONG)), strict=False)


def _parts(function: ast.FunctionDef) -> Iterator[str]:
    """The types of the syntax of a function, in their order, and the names of attributes."""
    for node in ast.walk(function):
        if not isinstance(node, ast.Load | ast.Store | ast.Constant | ast.arg | ast.Name):
            yield type(node).__name__ + getattr(node, "attr", "")
