"""A table with a row for each student, as Moodle, Canvas or a spreadsheet export it.

It may be in UTF-8, UTF-16 or Windows-1252 and have commas, semicolons or tabs between its cells;
it is written back in the same form. A list of names, one a line, is a table, too.

`match` finds who in the roster handed what in, by every name and number that a file and a row
share.
"""

import codecs
import csv
import io
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.marks.handed_in import HandedIn

KEYS = ("student", "SIS Login ID", "Username", "ID number", "Email address", "Identifier", "ID")
"""KEYS: the columns whose cells are the names of students in the table of marks, the best first;
without any, or where their cells are empty or equal, it is the first column that is neither."""
HEADINGS = {key.casefold() for key in KEYS} | {"name", "full name", "login", "e-mail", "email"}
"""HEADINGS: a file with one column begins with one of these, or with its first student."""
CANVAS = "SIS Login ID"
"""CANVAS: a column that only Canvas has. There a row without an ID is about no student."""
FULL_NAME = "name"
POSSIBLE = "Points Possible"
MARKS = {"utf-8-sig": codecs.BOM_UTF8, "utf-16": (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)}
Row = dict[str, str]


@dataclass(frozen=True)
class Roster:
    """The rows of a file, each a dict by column, and how the file was written.

    `students` are the rows of students by the cell of `key`; `others` are such as that with the
    points possible.
    """

    columns: tuple[str, ...]
    students: dict[str, Row]
    others: tuple[Row, ...]
    encoding: str
    delimiter: str

    def write(self, path: Path, rows: Sequence[Mapping]) -> None:
        """Write rows, which may have further columns, in the form of the file that was read."""
        columns = list(dict.fromkeys([*self.columns, *(name for row in rows for name in row)]))
        with (
            atomic_write(path) as temporary,
            temporary.open("w", newline="", encoding=self.encoding) as file,
        ):
            writer = csv.DictWriter(file, columns, "", delimiter=self.delimiter)
            writer.writeheader()
            writer.writerows(rows)

    def write_with(self, path: Path, points: Mapping[str, Row], possible: Row) -> None:
        """Write the rows with the points of each student, and a row with the points possible."""
        first = self.columns[0]
        others = [row | possible if POSSIBLE in row[first] else row for row in self.others]
        if CANVAS in self.columns and not any(POSSIBLE in row[first] for row in others):
            others.insert(0, dict.fromkeys(self.columns, "") | {first: POSSIBLE} | possible)
        self.write(path, [*others, *(row | points[key] for key, row in self.students.items())])


def read_roster(path: Path) -> Roster:
    """Read a table of students; a ValueError says what is wrong with it and in which line."""
    text, encoding = decoded(path.read_bytes())
    first = text.lstrip().partition("\n")[0]
    delimiter = max(",;\t", key=lambda each: len(next(csv.reader([first], delimiter=each), ())))
    lines = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    try:
        cells = [line for line in lines if any(cell.strip() for cell in line)]
    except csv.Error as error:
        raise ValueError(f"{path}: line {lines.line_num}: {error}") from None
    if cells and max(map(len, cells)) == 1 and cells[0][0].strip().casefold() not in HEADINGS:
        cells.insert(0, ["student"])  # a list of names without a heading
    columns = tuple(cells[0]) if cells else ()
    rows = [dict(zip(columns, [*line, *[""] * len(columns)], strict=False)) for line in cells[1:]]
    others = [row for row in rows if CANVAS in columns and not row.get("ID", "-").strip()]
    students = [row for row in rows if row not in others]
    if not students:
        raise ValueError(f"{path}: no row of a student below a row of headings")
    key = _key(columns, students)
    if key is None:
        raise ValueError(f"{path}: in no column are all cells filled and different")
    by_key = {row[key].strip(): row for row in students}
    return Roster(columns, by_key, tuple(others), encoding, delimiter)


def _key(columns: Sequence[str], students: Sequence[Row]) -> str | None:
    """The column that names the students."""

    def names_everyone(column: str) -> bool:
        cells = {row[column].strip() for row in students} - {""}
        return len(cells) == len(students)

    preferred = [key for key in KEYS if key in columns]
    return next(filter(names_everyone, [*preferred, *columns]), None)


def decoded(content: bytes) -> tuple[str, str]:
    """The text of a file, and its encoding."""
    marked = [name for name, mark in MARKS.items() if content.startswith(mark)]
    for encoding in (*marked, "utf-8", "cp1252"):
        with suppress(UnicodeDecodeError):
            return content.decode(encoding), encoding
    return content.decode("latin-1"), "latin-1"


def squashed(text: str) -> str:
    """The letters and digits of a text, as Canvas writes names: all small."""
    return "".join(c for c in text.casefold() if c.isalnum())


def match(files: Sequence[HandedIn], roster: Roster) -> tuple[dict[str, str], list[str]]:
    """The row of everyone who handed something in, and lines that say by what, no match first.

    A row is known by its key, a student by the name in the files. What is equal in two rows, such
    as a group, identifies nobody. Without a row is a student whose names and numbers are in none,
    or lead to several.
    """
    owners: dict[tuple[str, str], list[str]] = defaultdict(list)
    for key, row in roster.students.items():
        for identifier in _identifiers(row):
            owners[identifier].append(key)
    found: dict[str, str] = {}
    by: dict[str, str] = {}
    missing: dict[str, str] = {}
    for file in files:
        shared: dict[str, str] = {}
        for called, column in product(file.called, [*roster.columns, FULL_NAME]):
            keys = owners[column, squashed(called)]
            if len(keys) == 1:
                shared.setdefault(keys[0], f"{column} {called}")
        if len(shared) == 1:
            found[file.student] = next(iter(shared))
            by[file.student] = shared[found[file.student]]
        else:
            why = f"it may be {', '.join(shared)}" if shared else "nothing like it in the roster"
            missing[file.student] = why
    lines = [f"NO ROW      {student}: {why}" for student, why in missing.items()]
    lines += [f"NO FILE     {key}" for key in roster.students if key not in found.values()]
    lines += [f"{key:11} {student}, by {by[student]}" for student, key in found.items()]
    return found, lines


def _identifiers(row: Row) -> set[tuple[str, str]]:
    """What the cells of a row may be called in the name of a file, each with its column.

    The last column is that of full names, of the first two cells, such as a first and a last name.
    """
    called = [(column, name) for column, cell in row.items() for name in _called(cell)]
    first, *others = [*row.values()][:2]
    called += [(FULL_NAME, "".join([first, *others])), (FULL_NAME, "".join([*others, first]))]
    return {(column, squashed(name)) for column, name in called if squashed(name)}


def _called(cell: str) -> Iterator[str]:
    """Ann Lee and Lee, Ann are AnnLee and LeeAnn; ann@here.org is ann, Participant 7 is 7."""
    last, comma, first = cell.partition(",")
    words = [first, last] if comma else cell.split()
    yield from (cell, cell.partition("@")[0])
    for order in (words, words[1:] + words[:1], words[-1:] + words[:-1]):
        yield "".join(order)
    yield from (word for word in words[-1:] if word.isdecimal())
