"""The results of grading for other programs, as JSON.

    {"results": [{"student": "ann", "file": "ann_03.ipynb", "exercise": "conv1d", "points": 8,
                  "possible": 40, "text": "conv1d ..."}, ...]}

A file that cannot be graded has one result, whose exercise is null and whose text says why.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from numpy_cae.atomic_write import atomic_write
from numpy_cae.verify.grading.student_file import FileReport
from numpy_cae.visible import visible


def write_results(path: Path, reports_of: Mapping[str, Sequence[FileReport]]) -> None:
    """Write a result for each exercise of each student's files."""
    results: list[dict[str, Any]] = []
    for student, files in reports_of.items():
        for file in files:
            results += _results_of(student, file)
    with atomic_write(path) as temporary:
        text = json.dumps({"results": results}, indent=1, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")


def _results_of(student: str, file: FileReport) -> Iterator[dict[str, Any]]:
    """The results of a file, one for each exercise and one for what is wrong with the file."""
    origin = {"student": visible(student), "file": visible(file.path.name)}
    for report in file.reports:
        yield {
            **origin,
            "exercise": report.operation,
            "points": report.points,
            "possible": report.possible,
            "text": visible(str(report)),
        }
    if file.faults and not file.reports:
        text = visible("\n".join(file.faults))
        yield {**origin, "exercise": None, "points": 0, "possible": 0, "text": text}
