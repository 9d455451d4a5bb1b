"""The students' copies of the lessons, with a stub in place of each solution.

The copies are written into a folder, or into a release for nbgrader. Notebook
files are JSON, nbformat 4.5.
"""

import json
import re
import zipfile
from collections.abc import Iterator
from copy import deepcopy
from importlib.resources import files
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.course.cells import EMPTY, FILE
from numpy_cae.verify.grading.submission import is_exercise


def find_lessons(folder: str | Path) -> list[Path]:
    """The lessons in a folder, such as 03_convolution_by_hand.ipynb, in their order.

    Raises a FileNotFoundError if there are none.
    """
    lessons = sorted(Path(folder).glob("[0-9][0-9]*_*.ipynb"))
    if not lessons:
        where = "they are in the folder lessons of a clone of the repository"
        raise FileNotFoundError(f"no lessons in {folder}: {where}")
    return lessons


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


def write_notebook(notebook: dict, path: str | Path) -> None:
    """Write a notebook."""
    with atomic_write(path) as temporary:
        temporary.write_text(as_text(notebook), encoding="utf-8")


BEGIN, END = "### BEGIN SOLUTION", "### END SOLUTION"
STUB = ("# YOUR CODE HERE", "raise NotImplementedError()")
SOLUTION = re.compile(rf"^( *){BEGIN}\n(?:(?! *{BEGIN}).*\n)*? *{END}$", re.MULTILINE)
PACKAGED = Path(str(files(__package__) / "notebooks"))
"""The folder of the students' copies that are part of the package."""
STUBBED = re.compile(f"( *){STUB[0]}\n *({re.escape(STUB[1])})")
IN_REGION = rf"\1{BEGIN}\n\1\2\n\1{END}"
"""As `nbgrader generate_assignment` wants a stub."""
MILESTONES = "milestone_*.ipynb"
"""MILESTONES: notebooks without exercises, which run on mine.py alone."""


def student_copy(notebook: dict) -> dict:
    """A copy of the notebook with a stub in place of every solution, and without outputs.

    Raises ValueError if a solution region is not closed, or is in a cell that is no exercise.
    """
    copy = deepcopy(notebook)
    copy["metadata"].pop("numpy_cae", None)
    for cell in copy["cells"]:
        if cell["cell_type"] != "code":
            continue
        cell |= {"outputs": [], "execution_count": None}
        cell["source"] = _without_solutions(cell)
        if cell["metadata"].get("nbgrader", {}).get("locked"):
            cell["metadata"] |= {"editable": False, "deletable": False}
    return copy


def _without_solutions(cell: dict) -> str:
    source, count = SOLUTION.subn("\n".join(rf"\1{line}" for line in STUB), cell["source"])
    if BEGIN in source or END in source:
        raise ValueError(f"cell {cell['id']}: {BEGIN} without {END}, or the other way round")
    if count and not is_exercise(cell):
        raise ValueError(f"cell {cell['id']}: a solution in a cell that is no exercise")
    return source


def choose_lessons(folder: Path, numbers: list[str]) -> list[Path]:
    """The lessons in a folder with these numbers, or all; ValueError if one is missing."""
    lessons = find_lessons(folder)
    if missing := set(numbers) - {number_of(path) for path in lessons}:
        there = ", ".join(number_of(path) for path in lessons)
        raise ValueError(f"no lesson {', '.join(sorted(missing))} in {folder}; there are {there}")
    return [path for path in lessons if not numbers or number_of(path) in numbers]


def write_copies(lessons: list[Path], folder: Path) -> Iterator[tuple[Path, bool]]:
    """Write students' copies, the milestones beside them and mine.py; yields each file, and whether
    it was written.

    An existing file is not changed.
    """
    if any(folder.resolve() == path.parent.resolve() for path in lessons):
        raise ValueError(f"{folder} holds the instructor's copies: name another folder")
    sources = [*lessons, *sorted(lessons[0].parent.glob(MILESTONES))]
    texts = {path.name: as_text(student_copy(read_notebook(path))) for path in sources}
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in {**texts, FILE: EMPTY}.items():
        if new := not (folder / name).exists():
            with atomic_write(folder / name) as temporary:
                temporary.write_text(text, encoding="utf-8")
        yield folder / name, new


def write_release(lessons: list[Path], path: Path) -> None:
    """Write a zip file to be unpacked in the folder of an nbgrader course.

    NAME is the name of the file. `release/NAME` has the students' copies and mine.py. From
    `source/NAME`, `nbgrader generate_assignment NAME` makes the same copies; it has the points and
    no solutions. With nbgrader_config.py, nbgrader gives the marks of `numpy-cae verify`.
    """
    config = files(__package__).joinpath("nbgrader_config.txt").read_text(encoding="utf-8")
    with (
        atomic_write(path) as temporary,
        zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as packed,
    ):
        packed.writestr("nbgrader_config.py", config)
        for folder in ("release", "source"):
            packed.writestr(f"{folder}/{path.stem}/{FILE}", EMPTY)
        for lesson in lessons:
            copy = student_copy(read_notebook(lesson))
            packed.writestr(f"release/{path.stem}/{lesson.name}", as_text(copy))
            for cell in copy["cells"]:
                cell["source"] = STUBBED.sub(IN_REGION, cell["source"])
            packed.writestr(f"source/{path.stem}/{lesson.name}", as_text(copy))
