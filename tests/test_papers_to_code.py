"""lessons/papers_to_code.md tells the truth: names in its maps exist, every operation is in."""

import importlib
import re
from pathlib import Path

import pytest

from numpy_cae import ops

TEXT = (Path(__file__).parents[1] / "lessons" / "papers_to_code.md").read_text(encoding="utf-8")
ROWS = [line for line in TEXT.splitlines() if line.startswith("| ") and "`numpy_cae." in line]
NAMES = sorted({name for row in ROWS for name in re.findall(r"`(numpy_cae[\w.]+)`", row)})


def resolved(name: str):
    """The object that a dotted name means."""
    parts = name.split(".")
    for split in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:split]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[split:]:
            found = getattr(found, attribute)
        return found
    raise ImportError(name)


def test_the_map_is_there():
    assert len(ROWS) > 25


@pytest.mark.parametrize("name", NAMES)
def test_a_name_in_the_map_exists(name):
    assert resolved(name) is not None


@pytest.mark.parametrize("operation", ops.__all__)
def test_every_operation_is_in_the_map(operation):
    assert f"numpy_cae.ops.{operation}" in NAMES


@pytest.mark.parametrize("equation", ["eq. 1", "eq. 2", "eq. 3", "eq. 4"])
def test_every_equation_built_so_far_is_in_the_map(equation):
    assert any(equation in row for row in ROWS)
