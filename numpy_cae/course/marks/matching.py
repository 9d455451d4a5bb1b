"""Who in the roster handed what in, by every name and number that a file and a row share."""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from numpy_cae.course.marks.handed_in import HandedIn
from numpy_cae.course.marks.roster import Cells, Roster

FULL_NAME = "name"
"""The column of full names, which are made of the first two cells of a row."""
NUMBER = "number in"
"""What stands before a column in which a number is a part of a cell."""
MOST_NAMESAKES = 4
"""What at most this many rows share is perhaps a name; what more share is something else, such as a
group."""
WHOLE_NUMBER = re.compile(r"(?<![\d.,])\d+(?![.,]?\d)")
"""A number in a cell, such as 1327603 of Teilnehmer/in1327603; none is a part of 12.50."""

Identifier = tuple[str, str]
"""A column of the roster, and the letters and digits of what a student may be called by it."""


@dataclass
class Matching:
    """Which row of the roster is whose.

    Attributes
    ----------
    row_of : dict of str to str
        The row of the roster, by its name, of each student that a file is of.
    matched_by : dict of str to str
        The column and the name or number by which a student was matched.
    candidates : dict of str to list of str
        The rows that may be those of each student who was not matched; none where nothing in the
        roster is like the student's names.
    """

    row_of: dict[str, str] = field(default_factory=dict)
    matched_by: dict[str, str] = field(default_factory=dict)
    candidates: dict[str, list[str]] = field(default_factory=dict)

    def claimants(self, row: str) -> list[str]:
        """The students without a row to whom a row may belong.

        Whoever is like no row may be anybody who has handed nothing in.
        """
        is_matched = row in self.row_of.values()
        students = []
        for student, rows in self.candidates.items():
            if row in rows or not (rows or is_matched):
                students.append(student)
        return students

    def lines(self, roster: Iterable[str], team_of: Mapping[str, Sequence[str]]) -> Iterator[str]:
        """By what each student was matched, for the rows of a roster by their names.

        Students without a row come first, then rows without a student, nor one of their team.
        """
        for student, rows in self.candidates.items():
            if rows:
                yield f"NO ROW      {student}: it may be {' or '.join(rows)}"
            else:
                yield f"NO ROW      {student}: nothing like it in the roster"
        matched = set(self.row_of.values())
        for row in roster:
            if not matched.isdisjoint(team_of.get(row, [row])):
                continue
            claimants = self.claimants(row)
            if claimants:
                yield f"NO FILE     {row}: left empty, since {' or '.join(claimants)} may be it"
            else:
                yield f"NO FILE     {row}"
        for student, row in self.row_of.items():
            yield f"{row:11} {student}, by {self.matched_by[student]}"


def letters_and_digits(text: str) -> str:
    """The letters and digits of a text, as Canvas writes names: all small."""
    return "".join(character for character in text.casefold() if character.isalnum())


def match_students(files: Sequence[HandedIn], roster: Roster) -> Matching:
    """Find the row of everyone who handed something in.

    A student is matched by a name or number that leads to one row only. What is equal in several
    rows, such as a group or the name of two students, identifies nobody. A number within a cell
    counts where nothing else is equal. Without a row is a student whose names and numbers are in
    none, or lead to several; and two students with numbers of their own whose name leads to the
    same row with the same lesson.
    """
    rows_by_identifier = _rows_by_identifier(roster)
    matching = Matching()
    for file in files:
        columns = [*roster.columns, FULL_NAME]
        rows, namesakes = _find_rows(file, columns, rows_by_identifier)
        if not rows:
            numbers = [f"{NUMBER} {column}" for column in roster.columns]
            rows, _ = _find_rows(file, numbers, rows_by_identifier)
        if len(rows) == 1:
            row = next(iter(rows))
            matching.row_of[file.student] = row
            matching.matched_by[file.student] = rows[row]
        else:
            candidates = rows or namesakes
            in_order = [row for row in roster.students if row in candidates]
            matching.candidates[file.student] = in_order
    for student in _sharing_a_row(files, matching):
        matching.candidates[student] = [matching.row_of.pop(student)]
    return matching


def _sharing_a_row(files: Sequence[HandedIn], matching: Matching) -> list[str]:
    """Students of a download who have different numbers, and one row by their name for a lesson."""
    students: dict[tuple[str, str], set[str]] = defaultdict(set)
    for file in files:
        number, *names = file.names
        row = matching.row_of.get(file.student, "")
        if names and row and not matching.matched_by[file.student].endswith(f" {number}"):
            students[row, file.lesson].add(file.student)
    sharing = set()
    for together in students.values():
        if len(together) > 1:
            sharing |= together
    return sorted(sharing)


def _find_rows(
    file: HandedIn, columns: Sequence[str], rows_by_identifier: dict[Identifier, list[str]]
) -> tuple[dict[str, str], list[str]]:
    """The rows that a file's names and numbers lead to, each with what leads to it.

    The second result has the rows that share the name of the file's student.
    """
    rows: dict[str, str] = {}
    namesakes: list[str] = []
    for name in file.names:
        matched: dict[str, str] = {}
        for column in columns:
            students = rows_by_identifier[column, letters_and_digits(name)]
            if len(students) <= MOST_NAMESAKES:
                for student in students:
                    matched.setdefault(student, f"{column} {name}")
        if len(matched) == 1:
            rows |= {student: by for student, by in matched.items() if student not in rows}
        else:
            namesakes += matched
    return rows, list(dict.fromkeys(namesakes))


def _rows_by_identifier(roster: Roster) -> dict[Identifier, list[str]]:
    """The students of the roster that each identifier may mean."""
    students = defaultdict(list)
    for student, cells in roster.students.items():
        for identifier in _identifiers(cells):
            students[identifier].append(student)
    return students


def find_row(name: str, roster: Roster) -> str:
    """The row with a name or number; a ValueError says that there is none, or that there are
    several.
    """
    if name in roster.students:
        return name
    names = {letters_and_digits(name)}
    rows = []
    for student, cells in roster.students.items():
        if names & {identifier for _, identifier in _identifiers(cells)}:
            rows.append(student)
    if len(rows) != 1:
        problem = f"it may be {' or '.join(rows)}" if rows else "nothing like it in the roster"
        raise ValueError(f"{name}: {problem}")
    return rows[0]


def _identifiers(cells: Cells) -> set[Identifier]:
    """What a row of the roster may be called in the name of a file, each with its column."""
    names = [(FULL_NAME, name) for name in _full_names(cells)]
    for column, cell in cells.items():
        names += [(column, name) for name in _forms_of_name(cell)]
        names += [(f"{NUMBER} {column}", number) for number in WHOLE_NUMBER.findall(cell)]
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
