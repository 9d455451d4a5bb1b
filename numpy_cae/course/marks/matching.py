"""Who in the roster handed what in: by every name and number that a file and a row share."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from numpy_cae.course.marks.handed_in import HandedIn
from numpy_cae.course.marks.roster import Roster, identifiers, squashed


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
