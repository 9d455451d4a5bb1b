"""`--json`: one value on standard output, whatever is in a result, and nothing beside it."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.cli.as_json import plain, print_json
from numpy_cae.motion import write_bvh

TINY = (
    "--epochs 1 --fine-epochs 1 --fine-rate 0.05 --filters 6 8 --taps 5 --window 32 --overlap 16 "
    "--quiet"
).split()


@dataclass(frozen=True)
class Found:
    name: str
    figures: dict
    held: bool


def test_whatever_a_result_is_made_of(capsys):
    figures = {1: np.float32(0.5), "none": np.nan, "far": -np.inf, "many": np.arange(3)}
    found = Found("é", figures, np.bool_(True))
    print_json({"all": [found, (None, Path("a"))]})
    said = capsys.readouterr().out
    assert "é" in said
    figures = {"1": 0.5, "none": None, "far": None, "many": [0, 1, 2]}
    assert json.loads(said) == {
        "all": [{"name": "é", "figures": figures, "held": True}, [None, "a"]]
    }
    with pytest.raises(TypeError, match="bytes has no form"):
        plain({"picture": b"PNG"})


def test_trained_and_compared(tmp_path, capsys):
    for seed in range(3):
        take = make_take("walk", seed, seconds=2.0, rate=30.0)
        write_bvh(take.motion, tmp_path / f"walk_{seed}.bvh", unit=0.01)
    model = tmp_path / "m.npz"
    argv = ["train", str(tmp_path), "-o", str(model), "--test", "*_2.bvh", "--json", *TINY]
    assert main(argv) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["model"] == str(model)
    assert said["settings"]["takes"] == 2
    (table,) = said["test"]["tables"]
    assert {row[0] for row in table["rows"]} >= {"the network", "PCA on windows"}
    assert all(row[2] >= 0 for row in table["rows"])
    assert main([*argv, "--resume"]) == 0
    assert json.loads(capsys.readouterr().out)["test"] is None

    assert main(["compare", str(tmp_path), "-m", str(model), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    matrix = np.array(said["matrix"])
    assert matrix.shape == (3, 3)
    assert np.allclose(matrix, matrix.T)
    nearest = np.argmin(np.where(np.eye(3), np.inf, matrix), axis=1)
    assert said["nearest"] == [said["motions"][other] for other in nearest]
