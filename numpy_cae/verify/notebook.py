"""The functions that a student wrote in a lesson's notebook, as a Python file to be graded."""

from __future__ import annotations

import json

from numpy_cae.errors import NumpyCaeError

PREAMBLE = "import numpy as np\n"


class NotebookError(NumpyCaeError):
    """A file is not a notebook with exercise cells."""


def exercise_source(notebook: bytes) -> str:
    """The exercise cells of an .ipynb file, which nbgrader marks as solutions, as one program.

    Raises
    ------
    NotebookError
        If it is not a notebook, or has no such cell.
    """
    try:
        cells = json.loads(notebook)["cells"]
        exercises = [_source(cell) for cell in cells if is_exercise(cell)]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise NotebookError(f"it is not a Jupyter notebook: {error}") from None
    if not exercises:
        raise NotebookError("it has no exercise cell: is it a copy of a lesson?")
    return "\n\n".join([PREAMBLE, *exercises])


def is_exercise(cell: dict) -> bool:
    """Whether a cell is one that a student fills."""
    marks = cell["metadata"].get("nbgrader", {})
    return cell["cell_type"] == "code" and bool(marks.get("solution"))


def _source(cell: dict) -> str:
    source = cell["source"]
    return source if isinstance(source, str) else "".join(source)
