"""Execute a lesson in a fresh kernel, and store its outputs with a hash of its source."""

import hashlib
import json
import os
import subprocess
import tempfile
from pathlib import Path

from numpy_cae.course.mine import EMPTY, FILE

SECONDS_A_CELL = 1800


def source_hash(notebook: dict) -> str:
    """A hash of the source of all code cells, which is stored with the outputs."""
    sources = [cell["source"] for cell in notebook["cells"] if cell["cell_type"] == "code"]
    return hashlib.sha256("\0".join(sources).encode()).hexdigest()


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
