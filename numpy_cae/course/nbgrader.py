"""nbgrader's marks: those of `numpy-cae verify`, each exercise tested in a process of its own.

`nbgrader_config.py` of a release puts `grade_notebook` in the place of nbgrader's execution.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from numpy_cae.course.notebook import write_notebook
from numpy_cae.verify.grading import grade
from numpy_cae.verify.reporting import Report


def grade_notebook(notebook, resources):
    """Write report and points of each exercise into its check cell, as a preprocessor of nbconvert.

    nbgrader takes the number that a check cell shows for its points.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"{resources['nbgrader']['notebook']}.ipynb")
        write_notebook(notebook, path)
        graded = grade(path, "numpy_cae.course.catalogue")
    reports = {report.operation: report for report in graded.reports}
    for cell in notebook.cells:
        marks = cell.metadata.get("nbgrader", {})
        if marks.get("grade"):
            report = reports.get(marks["grade_id"].removesuffix("_check"))
            cell.outputs = _outputs(report, "\n".join(graded.faults))
    return notebook, resources


def _outputs(report: Report | None, faults: str) -> list:
    from nbformat import v4

    text = str(report) if report else faults or "not graded"
    points = str(report.points if report else 0)
    return [
        v4.new_output("stream", name="stdout", text=f"{text}\n"),
        v4.new_output("execute_result", {"text/plain": points}, execution_count=None),
    ]
