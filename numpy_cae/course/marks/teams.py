"""Teams: the mark of a file counts for all students of the team that handed it in."""

from pathlib import Path

from numpy_cae.course.marks.matching import find_row
from numpy_cae.course.marks.roster import Roster, read_text


def read_teams(path: Path, roster: Roster) -> dict[str, list[str]]:
    """The members of the team of each student, the student among them.

    A line has the members of a team, separated by commas, semicolons or tabs. With a roster, a
    member is named by anything that only one row has. A ValueError says which name is not found or
    is in two teams.
    """
    text, _ = read_text(path)
    team_of: dict[str, list[str]] = {}
    for number, line in enumerate(text.splitlines(), 1):
        names = [name.strip() for name in line.replace(";", ",").replace("\t", ",").split(",")]
        names = [name for name in names if name]
        try:
            if roster.students:
                names = [find_row(name, roster) for name in names]
        except ValueError as error:
            raise ValueError(f"{path}: line {number}: {error}") from None
        for name in names:
            if name in team_of:
                raise ValueError(f"{path}: line {number}: {name} is in two teams")
            team_of[name] = names
    return team_of
