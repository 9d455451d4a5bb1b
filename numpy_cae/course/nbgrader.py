"""The marks of `numpy-cae verify` for nbgrader: each exercise is tested in a separate process.

The `nbgrader_config.py` of a release replaces nbgrader's execution by `grade_notebook`.
"""

import tempfile
from pathlib import Path

from nbformat import v4

from numpy_cae.course import catalogue
from numpy_cae.course.copies import write_notebook
from numpy_cae.verify.grading.report import Report
from numpy_cae.verify.grading.student_file import grade


def grade_notebook(notebook, resources):
    """Write report and points of each exercise into its check cell, as a preprocessor of nbconvert.

    nbgrader takes the number that a check cell shows for its points.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"{resources['nbgrader']['notebook']}.ipynb")
        write_notebook(notebook, path)
        graded = grade(path, catalogue)
    checks = {}
    for cell in notebook.cells:
        marks = cell.metadata.get("nbgrader", {})
        if marks.get("grade"):
            checks[marks["grade_id"].removesuffix("_check")] = cell
            cell.outputs = _outputs("\n".join(graded.faults) or "not graded", 0)
    for report in graded.reports:
        if report.operation not in checks:
            checks[report.operation] = _check_cell(report)
            notebook.cells.append(checks[report.operation])
        checks[report.operation].outputs = _outputs(str(report), report.points)
    return notebook, resources


def _check_cell(report: Report):
    """The check cell of an exercise, for a student who has deleted it."""
    marks = {
        "cell_type": "code",
        "grade": True,
        "grade_id": f"{report.operation}_check",
        "locked": True,
        "points": report.possible,
        "schema_version": 3,
        "solution": False,
        "task": False,
    }
    return v4.new_code_cell(metadata={"nbgrader": marks})


def _outputs(text: str, points: int) -> list:
    return [
        v4.new_output("stream", name="stdout", text=f"{text}\n"),
        v4.new_output("execute_result", {"text/plain": str(points)}, execution_count=None),
    ]
