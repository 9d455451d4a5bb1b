"""Notebook files: JSON, nbformat 4.5."""

import json
from pathlib import Path

from numpy_cae.atomic_write import atomic_write


def find_lessons(folder: str | Path) -> list[Path]:
    """The lessons in a folder, such as 03_convolution_by_hand.ipynb, in their order.

    Raises a FileNotFoundError if there are none.
    """
    lessons = sorted(Path(folder).glob("[0-9][0-9]*_*.ipynb"))
    if not lessons:
        raise FileNotFoundError(
            f"no lessons in {folder}: they are in the folder lessons of a clone of the repository"
        )
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
