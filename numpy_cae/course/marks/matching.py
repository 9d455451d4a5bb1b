"""Who in the roster handed what in, by every name and number that a file and a row share."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from itertools import product

from numpy_cae.course.marks.handed_in import HandedIn
from numpy_cae.course.marks.roster import Cells, Roster

FULL_NAME = "name"
"""The column of full names, which are made of the first two cells of a row."""

Identifier = tuple[str, str]
"""A column of the roster, and the letters and digits of what a student may be called by it."""


def letters_and_digits(text: str) -> str:
    """The letters and digits of a text, as Canvas writes names: all small."""
    return "".join(character for character in text.casefold() if character.isalnum())


def match_students(files: Sequence[HandedIn], roster: Roster) -> tuple[dict[str, str], list[str]]:
    """Find the row of everyone who handed something in.

    What is equal in two rows, such as a group, identifies nobody. Without a row is a student whose
    names and numbers are in none, or lead to several.

    Parameters
    ----------
    files : sequence of HandedIn
    roster : Roster

    Returns
    -------
    row_of : dict of str to str
        The row of the roster, by its name, of each student that a file is of.
    lines : list of str
        By what each student was matched; students without a row come first, then rows without a
        student.
    """
    rows_by_identifier = _rows_by_identifier(roster)
    row_of: dict[str, str] = {}
    matched_by: dict[str, str] = {}
    unmatched: dict[str, str] = {}
    for file in files:
        rows: dict[str, str] = {}
        for name, column in product(file.names, [*roster.columns, FULL_NAME]):
            students = rows_by_identifier[column, letters_and_digits(name)]
            if len(students) == 1:
                rows.setdefault(students[0], f"{column} {name}")
        if len(rows) == 1:
            row = next(iter(rows))
            row_of[file.student] = row
            matched_by[file.student] = rows[row]
        elif rows:
            unmatched[file.student] = f"it may be {', '.join(rows)}"
        else:
            unmatched[file.student] = "nothing like it in the roster"
    lines = [f"NO ROW      {student}: {reason}" for student, reason in unmatched.items()]
    lines += [f"NO FILE     {row}" for row in roster.students if row not in row_of.values()]
    lines += [f"{row:11} {student}, by {matched_by[student]}" for student, row in row_of.items()]
    return row_of, lines


def _rows_by_identifier(roster: Roster) -> dict[Identifier, list[str]]:
    """The students of the roster that each identifier may mean."""
    students = defaultdict(list)
    for student, cells in roster.students.items():
        for identifier in _identifiers(cells):
            students[identifier].append(student)
    return students


def _identifiers(cells: Cells) -> set[Identifier]:
    """What a row of the roster may be called in the name of a file, each with its column."""
    names = [(FULL_NAME, name) for name in _full_names(cells)]
    for column, cell in cells.items():
        names += [(column, name) for name in _forms_of_name(cell)]
    identifiers = {(column, letters_and_digits(name)) for column, name in names}
    return {(column, name) for column, name in identifiers if name}


def _full_names(cells: Cells) -> tuple[str, str]:
    """The first two cells, such as a first and a last name, in both orders."""
    first, *second = [*cells.values()][:2]
    return "".join([first, *second]), "".join([*second, first])


def _forms_of_name(cell: str) -> Iterator[str]:
    """Ann Lee and Lee, Ann are AnnLee and LeeAnn; ann@here.org is ann, Participant 7 is 7."""
    last, comma, first = cell.partition(",")
    words = [first, last] if comma else cell.split()
    yield from (cell, cell.partition("@")[0])
    for order in (words, words[1:] + words[:1], words[-1:] + words[:-1]):
        yield "".join(order)
    if words and words[-1].isdecimal():
        yield words[-1]
