"""How a class did in each exercise: what to talk about in the next session."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path

from numpy_cae.course.catalogue import CATALOGUE
from numpy_cae.course.marks.roster import EMPTY_ROSTER
from numpy_cae.verify.grading.report import Report


def write_statistics(path: Path, best: Collection[Mapping[str, Report]]) -> None:
    """Write how often each property failed, the most frequent one first.

    Parameters
    ----------
    path : Path
    best : collection of dict of str to Report
        The best report of each student on each exercise.
    """
    rows = []
    for name, exercise in CATALOGUE.items():
        reports = [of_student[name] for of_student in best if name in of_student]
        if reports:
            failures = count_failures(reports)
            handed_in = {
                "exercise": name,
                "handed in": len(reports),
                "mean points": round(sum(report.points for report in reports) / len(reports), 1),
                "possible": exercise.points,
            }
            for tested in exercise.properties:
                counted = {"property": tested.name, "failed": failures[tested.name]}
                rows.append((failures[tested.name], handed_in | counted))
    rows.sort(key=lambda row: -row[0])
    EMPTY_ROSTER.write(path, [cells for _, cells in rows])


def count_failures(reports: Sequence[Report]) -> Counter[str]:
    """How many reports have each property as one that does not hold."""
    failures: Counter[str] = Counter()
    for report in reports:
        failures.update(outcome.property_.name for outcome in report.failing())
    return failures
