"""README.md: its length, and the Python quick start, which runs."""

import re
from pathlib import Path

import pytest

from data_synth import make_take
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap import write_bvh

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
QUICK_START = re.search(r"```python\n(.*?)```", README, re.DOTALL)[1]


def test_the_readme_is_short():
    assert len(README.splitlines()) <= 80
    assert len(QUICK_START.splitlines()) <= 8


@pytest.fixture
def folder_with_takes(tmp_path, monkeypatch):
    (tmp_path / "takes").mkdir()
    for seed, name in enumerate(("take.bvh", "takes/walk.bvh")):
        write_bvh(make_take("walk", seed, seconds=4, rate=30).motion, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("webbrowser.open", lambda page: None)
    return tmp_path


def test_the_quick_start_runs(folder_with_takes):
    values = {}
    exec(QUICK_START, values)
    assert (folder_with_takes / "fixed.bvh").is_file()
    assert isinstance(values["manifold"], MotionManifold)
