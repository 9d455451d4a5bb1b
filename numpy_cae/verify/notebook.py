"""The functions that a student wrote in a lesson's notebook, as a Python file to be graded."""

from __future__ import annotations

import json

PREAMBLE = "import numpy as np\n"


def exercise_source(notebook: str) -> str:
    """The exercise cells of a notebook, one after the other, as a program.

    Parameters
    ----------
    notebook : str
        The text of an .ipynb file whose exercise cells are marked as nbgrader marks solutions.

    Raises
    ------
    ValueError
        If it is no notebook, or has no such cell.
    """
    try:
        cells = json.loads(notebook)["cells"]
        exercises = [_source(cell) for cell in cells if is_exercise(cell)]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"it is not a Jupyter notebook: {error}") from None
    if not exercises:
        raise ValueError("it has no exercise cell: is it a copy of a lesson?")
    return "\n\n".join([PREAMBLE, *exercises])


def is_exercise(cell: dict) -> bool:
    """Whether a cell is one that a student fills."""
    marks = cell["metadata"].get("nbgrader", {})
    return cell["cell_type"] == "code" and bool(marks.get("solution"))


def _source(cell: dict) -> str:
    source = cell["source"]
    return source if isinstance(source, str) else "".join(source)
