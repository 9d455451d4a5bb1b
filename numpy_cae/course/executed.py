"""Running a lesson from a fresh kernel, and telling whether its outputs are of its source."""

from __future__ import annotations

import hashlib
import os
import subprocess
import tempfile

SECONDS_A_CELL = 120


def source_hash(notebook: dict) -> str:
    """A hash of every code cell's source, which executing stores beside the outputs."""
    sources = [cell["source"] for cell in notebook["cells"] if cell["cell_type"] == "code"]
    return hashlib.sha256("\0".join(sources).encode()).hexdigest()


def execute(notebook: dict) -> dict:
    """The notebook with the outputs of a run from a fresh kernel, stopping at an error.

    The kernel runs in an empty folder and does not see NUMPY_CAE_DATA, so that what is stored is
    drawn from synthetic motion on every machine.

    Parameters
    ----------
    notebook : dict
        As `read_notebook` returns it; stays as it is.

    Raises
    ------
    ValueError
        If a cell raises, naming the cell and its error, or if nbclient is not installed.
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
        client = NotebookClient(
            node,
            timeout=SECONDS_A_CELL,
            kernel_name="python3",
            record_timing=False,
            coalesce_streams=True,
            resources={"metadata": {"path": folder}},
        )
        kept = {k: v for k, v in os.environ.items() if k != "NUMPY_CAE_DATA"}
        try:
            # What a kernel says on standard error is about its ports, not about the lesson.
            client.execute(env=kept | {"OPENBLAS_NUM_THREADS": "1"}, stderr=subprocess.DEVNULL)
        except CellExecutionError as error:
            raise ValueError(f"{_failing(node)} raises {error.ename}: {error.evalue}") from None
        except CellTimeoutError:
            raise ValueError(f"a cell takes longer than {SECONDS_A_CELL} s") from None
        except DeadKernelError:
            raise ValueError("the kernel died") from None
    executed = _as_dict(node)
    executed["metadata"]["numpy_cae"] = {"source_hash": source_hash(notebook)}
    executed["metadata"].pop("widgets", None)
    return executed


def _failing(notebook: dict) -> str:
    """The cell that raised, by its id and first line."""
    for cell in notebook["cells"]:
        if any(output["output_type"] == "error" for output in cell.get("outputs", ())):
            return f"cell {cell['id']} ({cell['source'].splitlines()[0]} ...)"
    return "a cell"


def _as_dict(node):
    """nbformat's nodes are dicts that compare and print otherwise; plain ones are easier kept."""
    if isinstance(node, dict):
        return {key: _as_dict(value) for key, value in node.items()}
    if isinstance(node, list):
        return [_as_dict(value) for value in node]
    return node
