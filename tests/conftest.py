"""What tests of every room share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """The folder of real motion files; where there is none, the test is skipped."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("NUMPY_CAE_DATA", beside))
    if not (folder / "bandai").is_dir():
        pytest.skip(f"no real motion files in {folder}; set NUMPY_CAE_DATA to where they are")
    return folder
