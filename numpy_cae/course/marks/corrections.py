"""Corrections of marks, such as after an appeal: a table that every run obeys.

student,exercise,points,reason
ann,conv1d,38,the pullback was right for the old text
"""

from dataclasses import dataclass
from pathlib import Path

from numpy_cae.course.catalogue import CATALOGUE
from numpy_cae.course.marks.roster import read_table

FILE = "corrections.csv"
"""The name of the file, in the folder of the table of marks."""
COLUMNS = ("student", "exercise", "points", "reason")


@dataclass(frozen=True)
class Correction:
    """A mark that counts in place of any other: a number of points or a word such as "excused"."""

    student: str
    exercise: str
    points: str
    reason: str


def read_corrections(folder: Path) -> list[Correction]:
    """The corrections in a folder, none if it has no such file; a ValueError names a wrong line."""
    path = folder / FILE
    if not path.exists() and not path.is_symlink():  # a link to nowhere is a mistake
        return []
    columns, rows = read_table(path)
    missing = [column for column in COLUMNS if column not in columns]
    if missing:
        needed = ", ".join(COLUMNS)
        raise ValueError(f"{path}: no column {missing[0]!r}; the first line has to be {needed}")
    corrections = []
    for row in rows:
        cells = [row[column].strip() for column in COLUMNS]
        correction = Correction(*cells)
        problem = _problem(correction)
        if problem:
            raise ValueError(f"{path}: {correction.student}, {correction.exercise}: {problem}")
        corrections.append(correction)
    return corrections


def _problem(correction: Correction) -> str:
    """What is wrong with a correction, or ""."""
    if correction.exercise not in CATALOGUE:
        return "there is no such exercise"
    if not correction.student or not correction.points:
        return "a student and points are needed"
    if not correction.reason:
        return "the reason is missing"
    possible = CATALOGUE[correction.exercise].points
    if not is_word(correction.points) and correction.points not in map(str, range(possible + 1)):
        return f"{correction.points} points, where whole numbers from 0 to {possible} are possible"
    return ""


def is_word(mark: str) -> bool:
    """Whether a mark is a word such as "excused", and no number."""
    try:
        float(mark)
    except ValueError:
        return True
    return False
