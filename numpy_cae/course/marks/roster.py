"""A table with a row for each student, as Moodle, Canvas or a spreadsheet export it.

It may be in UTF-8, UTF-16 or Windows-1252 and have commas, semicolons or tabs between its cells;
it is written back in the same form. A list of names, one a line, is a table, too.

`match` finds who in the roster handed what in, by every name and number that a file and a row
share.
"""

import codecs
import csv
import io
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
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


def identifiers(rows: Sequence[Row]) -> Iterator[tuple[str, list[set[str]]]]:
    """For each column what its cells may be called in the name of a file, row by row.

    The last column is that of full names, of the first two cells, such as a first and a last name.
    """
    for column in rows[0]:
        yield column, [_called(row[column]) for row in rows]
    pairs = [list(row.values())[:2] for row in rows]
    yield "name", [{squashed("".join(p)), squashed("".join(p[::-1]))} - {""} for p in pairs]


def _called(cell: str) -> set[str]:
    """Ann Lee and Lee, Ann are annlee and leeann; ann@here.org is ann, Participant 7 is 7."""
    last, comma, first = cell.partition(",")
    words = [first, last] if comma else cell.split()
    called = {
        cell,
        "".join(words),
        "".join(words[1:] + words[:1]),
        "".join(words[-1:] + words[:-1]),
    }
    if "@" in cell:
        called.add(cell.partition("@")[0])
    called |= {word for word in words[-1:] if word.isdecimal()}
    return {squashed(each) for each in called} - {""}


def squashed(text: str) -> str:
    """The letters and digits of a text, as Canvas writes names: all small."""
    return "".join(c for c in text.casefold() if c.isalnum())


@dataclass(frozen=True)
class Matching:
    """The row of each student who handed something in, and by what it was found.

    `found` has (the key of the row, what they share) by the student's name in the files; `missing`
    says why there is none.
    """

    found: dict[str, tuple[str, str]]
    missing: dict[str, str]
    without: tuple[str, ...]

    def key(self, student: str) -> str:
        """The name of a student in the table of marks."""
        return self.found.get(student, (student,))[0]

    def lines(self) -> Iterator[str]:
        """The matching as a table, what has no match first."""
        for student, why in self.missing.items():
            yield f"NO ROW      {student}: {why}"
        for key in self.without:
            yield f"NO FILE     {key}"
        for student, (key, shared) in self.found.items():
            yield f"{key:11} {student}, by {shared}"


def match(files: Sequence[HandedIn], roster: Roster) -> Matching:
    """Find the row of everyone who handed something in.

    What is equal in two rows, such as a group, identifies nobody. Without a row is a student whose
    names and numbers are in none, or lead to several.
    """
    keys = list(roster.students)
    by_called: dict[str, dict[str, str]] = {}
    for column, called in identifiers(list(roster.students.values())):
        counts = Counter(name for names in called for name in names)
        for key, names in zip(keys, called, strict=True):
            for name in names:
                if counts[name] == 1:
                    by_called.setdefault(name, {}).setdefault(key, column)
    found: dict[str, tuple[str, str]] = {}
    missing: dict[str, str] = {}
    for file in files:
        shared = _shared(file, by_called)
        if len(shared) == 1:
            found[file.student] = next(iter(shared.items()))
        else:
            rows = ", ".join(shared)
            missing[file.student] = f"it may be {rows}" if rows else "nothing like it in the roster"
    taken = {key for key, _ in found.values()}
    return Matching(found, missing, tuple(key for key in keys if key not in taken))


def _shared(file: HandedIn, by_called: dict[str, dict[str, str]]) -> dict[str, str]:
    """The rows that a file's names and numbers lead to, each with what it shares with the file."""
    rows: dict[str, str] = {}
    for called in file.called:
        for key, column in by_called.get(squashed(called), {}).items():
            rows.setdefault(key, f"{column} {called}")
    return rows
