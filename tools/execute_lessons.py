"""Execute the instructor's copies of lessons in fresh kernels and store outputs and points.

    python -m tools.execute_lessons 03 05       (without numbers: every lesson and milestone)
    python -m tools.execute_lessons milestone_07
    python -m tools.execute_lessons --store     the same without executing, after a change of text

The package's copies for students are written, too.
"""

import argparse
import hashlib
import json
import os
import re
import subprocess
import tempfile
from pathlib import Path

from numpy_cae.course.catalogue import EXERCISES
from numpy_cae.course.cells import EMPTY, FILE, with_definitions
from numpy_cae.course.copies import (
    choose_lessons,
    write_notebook,
)
from numpy_cae.course.notebooks import MILESTONES, find_lessons, read_notebook
from numpy_cae.verify.grading.submission import is_exercise

ROOT = Path(__file__).parents[1]
LESSONS = ROOT / "lessons"
IMPORTED = ("numpy_cae", "data_synth")
NOT_IMPORTED = [ROOT / "numpy_cae" / name for name in ("cli", "download", "course/notebooks")]
SECONDS_A_CELL = 1800


def source_hash(notebook: dict) -> str:
    """A hash of the source of all code cells, which is stored with the outputs."""
    sources = [cell["source"] for cell in notebook["cells"] if cell["cell_type"] == "code"]
    return hashlib.sha256("\0".join(sources).encode()).hexdigest()


def imports_hash(path: Path) -> str:
    """A hash of all that the execution of a lesson depends on, beside its own cells.

    These are the files of both packages, without the commands and the students' copies, and the
    solutions of the lessons before. The hash is stored with the outputs: where it is the same, the
    stored outputs are those of the present code, and the lesson need not be executed again.
    """
    digest = hashlib.sha256(mine_before(path).encode())
    for file in sorted(file for name in IMPORTED for file in ROOT.joinpath(name).rglob("*.*")):
        left_out = any(file.is_relative_to(folder) for folder in NOT_IMPORTED)
        if file.is_file() and file.suffix != ".pyc" and not left_out:
            digest.update(file.relative_to(ROOT).as_posix().encode() + file.read_bytes())
    return digest.hexdigest()


def execute(notebook: dict, mine: str = EMPTY, data: str | None = None) -> dict:
    """A copy of the notebook with the outputs of its execution in a fresh kernel.

    The kernel runs in a folder that contains only a file mine.py with the text `mine`. `data` is
    the value of NUMPY_CAE_DATA. By default the variable is not set, so that every machine stores
    results of synthetic motion. Raises a ValueError with the cell and its error if a cell raises,
    and a ValueError if nbclient is not installed.
    """
    try:
        import nbformat
        from nbclient import NotebookClient
        from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError
    except ImportError:
        raise ValueError(
            "executing lessons needs nbclient and ipykernel: pip install '.[lessons]' in a clone"
        ) from None
    node = nbformat.from_dict({**notebook, "cells": [dict(cell) for cell in notebook["cells"]]})
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, FILE).write_text(mine, encoding="utf-8")
        client = NotebookClient(
            node,
            timeout=SECONDS_A_CELL,
            startup_timeout=SECONDS_A_CELL,
            kernel_name="python3",
            record_timing=False,
            coalesce_streams=True,
            resources={"metadata": {"path": folder}},
        )
        kept = {k: v for k, v in os.environ.items() if k != "NUMPY_CAE_DATA"}
        kept |= {"NUMPY_CAE_DATA": data} if data else {}
        try:
            # A kernel's standard error is about its ports, not about the lesson.
            client.execute(env=kept | {"OPENBLAS_NUM_THREADS": "1"}, stderr=subprocess.DEVNULL)
        except CellExecutionError as error:
            raise ValueError(f"{_failing(node)} raises {error.ename}: {error.evalue}") from None
        except (CellTimeoutError, DeadKernelError) as error:
            raise ValueError(str(error)) from None
    executed = json.loads(json.dumps(node))  # plain dicts and lists
    executed["metadata"]["numpy_cae"] = {"source_hash": source_hash(notebook)}
    executed["metadata"].pop("widgets", None)
    return executed


def _failing(notebook: dict) -> str:
    """The cell that raised, by its id and first line."""
    for cell in notebook["cells"]:
        if any(output["output_type"] == "error" for output in cell.get("outputs", ())):
            return f"cell {cell['id']} ({cell['source'].splitlines()[0]} ...)"
    return "a cell"


def mine_before(lesson: Path) -> str:
    """The text of mine.py with the solutions of all lessons before this one, in its folder.

    The milestone of lesson 07 comes after it and before lesson 07b.
    """
    text = EMPTY
    name = re.sub(r"milestone_(\d+)", r"\1_~", lesson.name)
    for path in find_lessons(lesson.parent):
        if path.name < name:
            for cell in filter(is_exercise, read_notebook(path)["cells"]):
                text = with_definitions(text, cell["source"])
    return re.sub("^ +### .* SOLUTION\n", "", text, flags=re.M)


def set_points(notebook: dict) -> None:
    """Give the check cells of a notebook the points of their exercises."""
    for cell in notebook["cells"]:
        marks = cell["metadata"].get("nbgrader", {})
        if marks.get("grade"):
            marks["points"] = EXERCISES[marks["grade_id"].removesuffix("_check")].points


def store(path: Path, executed: bool) -> None:
    """Store a lesson's points and the package's copy and, if requested, new outputs."""
    notebook = read_notebook(path)
    set_points(notebook)
    if executed:
        notebook = execute(notebook, mine_before(path))
        notebook["metadata"]["numpy_cae"]["imports_hash"] = imports_hash(path)
        print(f"{path}: executed")
    write_notebook(notebook, path)


def main() -> None:
    """Execute or store the lessons that are named."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("numbers", nargs="*", metavar="NN")
    parser.add_argument("--store", action="store_true", help="keep the outputs that are stored")
    args = parser.parse_args()
    every = sorted(LESSONS.glob(MILESTONES))
    milestones = [path for path in every if path.stem in args.numbers or not args.numbers]
    numbers = [number for number in args.numbers if not number.startswith("milestone")]
    lessons = choose_lessons(LESSONS, numbers) if numbers or not args.numbers else []
    for path in [*lessons, *milestones]:
        store(path, not args.store)


if __name__ == "__main__":
    main()
