"""A table with a row for each student, as Moodle, Canvas or a spreadsheet export it.

It may be in UTF-8, UTF-16 or Windows-1252 and have commas, semicolons or tabs between its cells;
it is written back in the same form. A list of names, one a line, is a table, too.
"""

import codecs
import csv
import io
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from numpy_cae.atomic_write import atomic_write, replacing

NAME_COLUMNS = (
    "student",
    "SIS Login ID",
    "Username",
    "ID number",
    "Email address",
    "Identifier",
    "ID",
)
"""The columns whose cells are the names of students in the table of marks, the best first; without
any, or where their cells are empty or equal, it is the first column that is neither."""
HEADINGS = {name.casefold() for name in NAME_COLUMNS}
HEADINGS |= {"name", "full name", "login", "e-mail", "email"}
"""A file with one column begins with one of these, or with its first student."""
OF_CANVAS = "SIS Login ID"
"""A column that only Canvas has. There a row without an ID is about no student."""
POSSIBLE = "Points Possible"
LARGEST_TABLE = 2**24
"""A table may have at most this many bytes."""
BYTE_ORDER_MARKS = {
    "utf-32": (codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE),
    "utf-8-sig": (codecs.BOM_UTF8,),
    "utf-16": (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE),
}
Cells = dict[str, str]
"""The cells of a row, by the headings of their columns."""


@dataclass(frozen=True)
class Roster:
    """The rows of a file, and how the file was written.

    Attributes
    ----------
    columns : tuple of str
        The headings.
    students : dict of str to dict of str to str
        The rows of students by the student's name in the table of marks.
    other_rows : tuple of dict of str to str
        Rows of no student, such as that with the points possible.
    encoding, delimiter : str
    """

    columns: tuple[str, ...]
    students: dict[str, Cells]
    other_rows: tuple[Cells, ...]
    encoding: str
    delimiter: str

    def write(self, path: Path, rows: Sequence[Mapping[str, object]]) -> None:
        """Write rows, which may have further columns, in the form of the file that was read."""
        columns = dict.fromkeys(self.columns)
        for row in rows:
            columns |= dict.fromkeys(row)
        with (
            replacing(True),  # `keep_table` has kept what exists
            atomic_write(path) as temporary,
            temporary.open("w", newline="", encoding=self.encoding) as file,
        ):
            writer = csv.DictWriter(file, list(columns), "", delimiter=self.delimiter)
            writer.writeheader()
            writer.writerows(rows)


EMPTY_ROSTER = Roster((), {}, (), "utf-8", ",")
"""A roster without students, and the form in which tables are written."""


def read_roster(path: Path) -> Roster:
    """Read a table of students; a ValueError says what is wrong with it and in which line."""
    text, encoding = read_text(path)
    delimiter = _delimiter_of(path, text)
    columns, rows = _read_rows(path, text, delimiter)
    students: list[Cells] = []
    other_rows: list[Cells] = []
    for row in rows:
        if OF_CANVAS in columns and not row.get("ID", "-").strip():
            other_rows.append(row)
        else:
            students.append(row)
    if not students:
        raise ValueError(f"{path}: no row of a student below a row of headings")
    column = _name_column(columns, students)
    if column is None:
        raise ValueError(f"{path}: in no column are all cells filled and different")
    by_name = {row[column].strip(): row for row in students}
    return Roster(columns, by_name, tuple(other_rows), encoding, delimiter)


def read_table(path: Path) -> tuple[tuple[str, ...], list[Cells]]:
    """The headings of a table and its rows; a ValueError says what is wrong with it."""
    text, _ = read_text(path)
    return _read_rows(path, text, _delimiter_of(path, text))


def _delimiter_of(path: Path, text: str) -> str:
    """What stands between the cells of the first line: the one that makes most cells."""
    first_line = text.lstrip().partition("\n")[0]

    def count_cells(delimiter: str) -> int:
        return len(next(csv.reader([first_line], delimiter=delimiter), ()))

    try:
        return max(",;\t", key=count_cells)
    except csv.Error as error:
        raise ValueError(f"{path}: line 1: {error}: it is no table of students") from None


def _read_rows(path: Path, text: str, delimiter: str) -> tuple[tuple[str, ...], list[Cells]]:
    """The headings of a table and the cells of each row below."""
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    try:
        lines = [line for line in reader if any(cell.strip() for cell in line)]
    except csv.Error as error:
        raise ValueError(f"{path}: line {reader.line_num}: {error}") from None
    if not lines:
        return (), []
    has_one_column = max(map(len, lines)) == 1
    if has_one_column and lines[0][0].strip().casefold() not in HEADINGS:
        lines.insert(0, ["student"])  # a list of names without a heading
    columns = tuple(lines[0])
    missing = [""] * len(columns)
    rows = [dict(zip(columns, [*line, *missing], strict=False)) for line in lines[1:]]
    return columns, rows


def _name_column(columns: Sequence[str], students: Sequence[Cells]) -> str | None:
    """The column that names the students; None if there is none."""
    preferred = [column for column in NAME_COLUMNS if column in columns]
    for column in [*preferred, *columns]:
        names = {row[column].strip() for row in students} - {""}
        if len(names) == len(students):
            return column
    return None


def read_text(path: Path) -> tuple[str, str]:
    """The text of a table or a list, and its encoding; a ValueError says what is wrong with it."""
    if not path.is_file():
        problem = "it is no file" if path.exists() else "there is no such file"
        raise ValueError(f"{path}: {problem}")
    if path.stat().st_size > LARGEST_TABLE:
        raise ValueError(f"{path}: it is larger than {LARGEST_TABLE // 2**20} MB")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ValueError(f"{path}: cannot be read: {error.strerror}") from None
    for encoding, marks in BYTE_ORDER_MARKS.items():
        if content.startswith(marks):
            try:
                return content.decode(encoding), encoding
            except UnicodeDecodeError as error:
                name = encoding.removesuffix("-sig").upper()
                problem = f"it begins as {name}, and byte {error.start} is not: save it as UTF-8"
                raise ValueError(f"{path}: {problem}") from None
    for encoding in ("utf-8", "cp1252"):
        with suppress(UnicodeDecodeError):
            return content.decode(encoding), encoding
    return content.decode("latin-1"), "latin-1"
