"""Notebook files of lessons, and the student's copy of one: a stub in place of each solution.

Notebook files are JSON, nbformat 4.5. The module imports the standard library alone, because
`setup.py` loads it to build the package, where NumPy is not installed.
"""

import json
import re
from copy import deepcopy
from pathlib import Path

BEGIN = "### BEGIN SOLUTION"
END = "### END SOLUTION"
STUB = ("# YOUR CODE HERE", "raise NotImplementedError()")
SOLUTION = re.compile(rf"^( *){BEGIN}\n(?:(?! *{BEGIN}).*\n)*? *{END}$", re.MULTILINE)
MILESTONES = "milestone_*.ipynb"
"""Notebooks without exercises, which run on mine.py alone."""


def find_lessons(folder: str | Path) -> list[Path]:
    """The lessons in a folder, such as 03_convolution_by_hand.ipynb, in their order.

    Raises a FileNotFoundError if there are none.
    """
    lessons = sorted(Path(folder).glob("[0-9][0-9]*_*.ipynb"))
    if not lessons:
        where = "they are in the folder lessons of a clone of the repository"
        raise FileNotFoundError(f"no lessons in {folder}: {where}")
    return lessons


def find_milestones(folder: str | Path) -> list[Path]:
    """The milestones in a folder, such as milestone_08.ipynb."""
    return sorted(Path(folder).glob(MILESTONES))


def number_of(lesson: Path) -> str:
    """03 of 03_convolution_by_hand.ipynb, 07b of 07b_better_steps.ipynb."""
    return lesson.name.partition("_")[0]


def read_notebook(path: str | Path) -> dict:
    """A notebook in nbformat 4.5, each source as a single string; ValueError if it is none."""
    try:
        notebook = json.loads(Path(path).read_text(encoding="utf-8"))
        for cell in notebook["cells"]:
            cell["source"] = "".join(cell["source"])
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path}: not a Jupyter notebook: {error}") from None
    return notebook


def as_text(notebook: dict) -> str:
    """The text of a notebook's file as Jupyter writes it: sources line by line, indented by one."""
    cells = [
        {**cell, "source": cell["source"].splitlines(keepends=True)} for cell in notebook["cells"]
    ]
    lined = {**notebook, "cells": cells}
    return json.dumps(lined, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def student_copy(notebook: dict) -> dict:
    """A copy of the notebook with a stub in place of every solution, and without outputs.

    Raises ValueError if a solution region is not closed, or is in a cell that is no exercise.
    """
    copy = deepcopy(notebook)
    copy["metadata"].pop("numpy_cae", None)
    for cell in copy["cells"]:
        if cell["cell_type"] != "code":
            continue
        marks = cell["metadata"].get("nbgrader", {})
        cell["outputs"] = []
        cell["execution_count"] = None
        cell["source"] = _without_solutions(cell, bool(marks.get("solution")))
        if marks.get("locked"):
            cell["metadata"]["editable"] = False
            cell["metadata"]["deletable"] = False
    return copy


def _without_solutions(cell: dict, is_exercise: bool) -> str:
    """The source of a code cell with stubs."""
    stub = "\n".join(rf"\1{line}" for line in STUB)
    source, count = SOLUTION.subn(stub, cell["source"])
    if BEGIN in source or END in source:
        raise ValueError(f"cell {cell['id']}: {BEGIN} without {END}, or the other way round")
    if count and not is_exercise:
        raise ValueError(f"cell {cell['id']}: a solution in a cell that is no exercise")
    return source


def write_student_copies(lessons: Path, folder: Path) -> list[Path]:
    """Write the students' copies of all lessons and milestones; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for lesson in [*find_lessons(lessons), *find_milestones(lessons)]:
        path = folder / lesson.name
        path.write_text(as_text(student_copy(read_notebook(lesson))), encoding="utf-8")
        written.append(path)
    return written
