"""Tables of a class: marks, a file that Moodle and Canvas import, and which properties failed.

The roster is a CSV file with a row for each student, as these systems export it. Its first column
of `KEYS`, or else its first column, has the names of the submissions.
"""

import csv
from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from shutil import copyfile

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.catalogue import ASSIGNMENTS, CATALOGUE
from numpy_cae.verify.grading.report import Report
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import csv_cell

KEYS = ("student", "SIS Login ID", "Username", "ID number", "Email address")
CANVAS = "SIS Login ID"
"""CANVAS: a column that only Canvas has; its import needs a row with the points possible."""
MAXIMUM = "maximum"
Rows = dict[str, dict[str, str]]


def read_rows(path: Path) -> Rows:
    """The rows of a CSV file by the name of the student; a ValueError if there are none."""
    with path.open(newline="", encoding="utf-8-sig", errors="surrogateescape") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError(f"{path}: no row of a student below a row of headings")
    key = next((key for key in KEYS if key in rows[0]), next(iter(rows[0])))
    return {row[key].strip(): row for row in rows if (row[key] or "").strip()}


def write_tables(
    path: Path,
    by_student: Mapping[str, list[FileReport]],
    roster: Rows | None = None,
    due: datetime | None = None,
) -> None:
    """Write the marks, the statistics beside them and, with a roster, the file to import.

    The table has a row for everyone in the roster and everyone who handed something in. Of an
    exercise handed in more than once the best counts. Where the table exists, exercises that are
    not handed in now keep their marks, and the old table is kept under a name with a number.
    """
    roster = {csv_cell(name): row for name, row in (roster or {}).items()}
    before = read_rows(path) if path.exists() else {}
    before.pop(MAXIMUM, None)
    known = {name.casefold(): name for name in roster}  # a submission may have other capitals
    files = {known.get(csv_cell(n).casefold(), csv_cell(n)): each for n, each in by_student.items()}
    reports = {student: best(each) for student, each in files.items()}
    marked = {name for row in before.values() for name in row if name in CATALOGUE and row[name]}
    marked |= {name for of_one in reports.values() for name in of_one}
    lessons = {n: names for n, names in ASSIGNMENTS.items() if marked & set(names)}
    of_lessons = sum(lessons.values(), ())
    names = [*of_lessons, *(n for n in CATALOGUE if n in marked and n not in of_lessons)]
    table = [_row(MAXIMUM, {name: CATALOGUE[name].points for name in names}, lessons)]
    for student in dict.fromkeys([*roster, *files, *before]):
        new, old = reports.get(student, {}), before.get(student, {})
        points = {n: new[n].points if n in new else old.get(n) or "" for n in names}
        row, handed_in = _row(student, points, lessons), files.get(student, [])
        problems = [fault for each in handed_in for fault in each.faults]
        problems += [f"{n} missing" for n, value in row.items() if value == "" and "lesson" in n]
        problems += [f"{each.path.name} late" for each in handed_in if due and _time(each) > due]
        problems += ["not in the roster"] * bool(roster and student not in roster)
        row["possible"] = table[0]["total"]
        row["percent"] = round(100 * row["total"] / max(1, row["possible"]), 1)
        is_empty = not (handed_in or row["total"])
        row["problems"] = csv_cell("nothing handed in" if is_empty else "; ".join(problems))
        table.append(row)
    if path.exists():
        numbered = (path.with_suffix(f".{n}{path.suffix}") for n in range(1, 10_000))
        copyfile(path, next(free for free in numbered if not free.exists()))
    _write(path, table)
    _write(path.with_stem(f"{path.stem}_statistics"), _statistics(list(reports.values())))
    if roster:
        _write(path.with_stem(f"{path.stem}_import"), _to_import(roster, table, lessons))


def best(files: Sequence[FileReport]) -> dict[str, Report]:
    """The report with most points on each exercise of a student."""
    found: dict[str, Report] = {}
    for report in (report for each in files for report in each.reports):
        other = found.setdefault(report.operation, report)
        found[report.operation] = max(other, report, key=lambda each: each.points)
    return found


def _row(student: str, points: dict, lessons: Mapping[str, Sequence[str]]) -> dict:
    """The points of each exercise and each lesson, and their sum."""
    number = {name: int(float(value)) for name, value in points.items() if value != ""}
    sums = {n: [number[name] for name in names if name in number] for n, names in lessons.items()}
    of_lessons = {f"lesson {n}": sum(all_) if all_ else "" for n, all_ in sums.items()}
    total = sum(number.values())
    return {"student": student, **points, **of_lessons, "total": total}


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


def _to_import(roster: Rows, table: Sequence[dict], lessons: Mapping) -> list[dict]:
    """The roster with the points of each lesson: an empty cell counts 0 there."""
    marks = {row["student"]: row for row in table}

    def with_points(row: dict, student: str) -> dict:
        return row | {f"Lesson {n}": marks[student][f"lesson {n}"] or 0 for n in lessons}

    rows = [with_points(row, student) for student, row in roster.items()]
    if CANVAS in rows[0]:
        first = next(iter(rows[0]))
        rows.insert(
            0, with_points({**dict.fromkeys(rows[0], ""), first: "Points Possible"}, MAXIMUM)
        )
    return rows


def _time(handed_in: FileReport) -> datetime:
    return datetime.fromtimestamp(handed_in.path.stat().st_mtime)


def _write(path: Path, rows: Sequence[dict]) -> None:
    with atomic_write(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(dict.fromkeys(name for row in rows for name in row)), "")
        writer.writeheader()
        writer.writerows(rows)
