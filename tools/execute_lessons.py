"""Execute the instructor's copies of lessons in fresh kernels and store outputs and points.

    python -m tools.execute_lessons 03 05       (without numbers: every lesson and milestone)
    python -m tools.execute_lessons milestone_08
    python -m tools.execute_lessons --points    only the points and the alternative texts

Outputs change when a lesson changes, or a figure that it shows. That every lesson runs with the
present code is tested without storing: with short trainings by `pytest -m lessons -k short`, as
it is by `pytest -m lessons`.
"""

import argparse
import hashlib
import json
import os
import re
import subprocess
import tempfile
import tomllib
from copy import deepcopy
from dataclasses import replace
from functools import cache
from pathlib import Path

from numpy_cae.course.catalogue import CATALOGUE, EXERCISES
from numpy_cae.course.copies import choose_lessons, write_notebook
from numpy_cae.course.mine_file import EMPTY, FILE, with_definitions
from numpy_cae.course.notebooks import find_lessons, find_milestones, read_notebook
from numpy_cae.course.submitted_file import is_exercise

ROOT = Path(__file__).parents[1]
LESSONS = ROOT / "lessons"
SECONDS_A_CELL = 1800
SHORT_TRAININGS = tomllib.loads(Path(__file__).with_name("short_trainings.toml").read_text("utf-8"))
FEWER = 12
"""With short trainings a check cell tries the number of examples divided by this."""
FEW_EXAMPLES = """
from tools.execute_lessons import try_few_examples
try_few_examples()
"""
"""The cell before the first one of a lesson with short trainings."""


def source_hash(notebook: dict) -> str:
    """A hash of the source of all code cells, which is stored with the outputs."""
    sources = [cell["source"] for cell in notebook["cells"] if cell["cell_type"] == "code"]
    return hashlib.sha256("\0".join(sources).encode()).hexdigest()


def shorten(notebook: dict, lesson: Path) -> dict:
    """A copy of a lesson whose trainings take a second and whose checks try few examples.

    Raises a ValueError if `short_trainings.toml` names a text that the lesson does not have.
    """
    short = deepcopy(notebook)
    cells = {cell["id"]: cell for cell in short["cells"]}
    for cell_id, old, new in SHORT_TRAININGS.get(lesson.stem, ()):
        if cell_id not in cells or old not in cells[cell_id]["source"]:
            raise ValueError(f"{lesson.name}: no {old!r} in a cell {cell_id!r}")
        cells[cell_id]["source"] = cells[cell_id]["source"].replace(old, new)
    few = {"cell_type": "code", "id": "few-examples", "metadata": {}, "source": FEW_EXAMPLES}
    short["cells"].insert(0, few | {"outputs": [], "execution_count": None})
    return short


def try_few_examples() -> None:
    """Let checks in this process try few examples of each property."""
    for exercises in (CATALOGUE, EXERCISES):
        for name, exercise in exercises.items():
            few = [replace(p, examples=max(1, p.examples // FEWER)) for p in exercise.properties]
            exercises[name] = replace(exercise, properties=tuple(few))


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
        try:
            # A kernel's standard error is about its ports, not about the lesson.
            client.execute(env=_environment(data), stderr=subprocess.DEVNULL)
        except CellExecutionError as error:
            raise ValueError(f"{_failing(node)} raises {error.ename}: {error.evalue}") from None
        except (CellTimeoutError, DeadKernelError) as error:
            raise ValueError(str(error)) from None
    executed = json.loads(json.dumps(node))  # plain dicts and lists
    executed["metadata"]["numpy_cae"] = {"source_hash": source_hash(notebook)}
    executed["metadata"].pop("widgets", None)
    return executed


def describe_pictures(notebook: dict) -> None:
    """Give the pictures of an executed notebook their alternative texts.

    A code cell has a text for each of its pictures in its metadata, under "alt".
    """
    for cell in notebook["cells"]:
        texts = iter(cell["metadata"].get("alt", ()))
        for output in cell.get("outputs", ()):
            if "image/png" in output.get("data", {}):
                output["metadata"]["image/png"] = {"alt": next(texts, "")}


def _environment(data: str | None) -> dict[str, str]:
    """The environment of a kernel: the clone can be imported, and one thread is used."""
    environment = dict(os.environ)
    environment.pop("NUMPY_CAE_DATA", None)
    if data:
        environment["NUMPY_CAE_DATA"] = data
    environment["OPENBLAS_NUM_THREADS"] = "1"
    environment["PYTHONPATH"] = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    return environment


def _failing(notebook: dict) -> str:
    """The cell that raised, by its id and first line."""
    for cell in notebook["cells"]:
        if any(output["output_type"] == "error" for output in cell.get("outputs", ())):
            return f"cell {cell['id']} ({cell['source'].splitlines()[0]} ...)"
    return "a cell"


def mine_before(lesson: Path) -> str:
    """The text of mine.py with the solutions of all lessons before this one, in its folder.

    The milestone of lesson 08 comes after it and before lesson 09.
    """
    name = re.sub(r"milestone_(\d+)", r"\1_~", lesson.name)
    earlier = [path for path in find_lessons(lesson.parent) if path.name < name]
    return re.sub("^ +### .* SOLUTION\n", "", _mine_after(tuple(earlier)), flags=re.M)


@cache
def _mine_after(lessons: tuple[Path, ...]) -> str:
    """The text of mine.py with the solutions of these lessons."""
    if not lessons:
        return EMPTY
    *earlier, last = lessons
    text = _mine_after(tuple(earlier))
    for cell in filter(is_exercise, read_notebook(last)["cells"]):
        text = with_definitions(text, cell["source"])
    return text


def set_points(notebook: dict) -> None:
    """Give the check cells of a notebook the points of their exercises."""
    for cell in notebook["cells"]:
        marks = cell["metadata"].get("nbgrader", {})
        if marks.get("grade"):
            marks["points"] = EXERCISES[marks["grade_id"].removesuffix("_check")].points


def store(path: Path, executed: bool) -> None:
    """Store a lesson's points and alternative texts and, if requested, new outputs."""
    notebook = read_notebook(path)
    set_points(notebook)
    if executed:
        notebook = execute(notebook, mine_before(path))
        print(f"{path}: executed")
    describe_pictures(notebook)
    write_notebook(notebook, path)


def main() -> None:
    """Execute or store the lessons that are named."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("numbers", nargs="*", metavar="NN")
    parser.add_argument("--points", action="store_true", help="keep the outputs that are stored")
    args = parser.parse_args()
    milestones = [
        path for path in find_milestones(LESSONS) if path.stem in args.numbers or not args.numbers
    ]
    numbers = [number for number in args.numbers if not number.startswith("milestone")]
    lessons = choose_lessons(LESSONS, numbers) if numbers or not args.numbers else []
    for path in [*lessons, *milestones]:
        store(path, executed=not args.points)


if __name__ == "__main__":
    main()
