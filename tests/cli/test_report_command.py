"""The command `report` on a folder of synthetic takes and a tiny network."""

from __future__ import annotations

import json

import numpy as np
import pytest

from data_synth import plan_takes, write_series
from numpy_cae.cli import main
from numpy_cae.manifold import load_manifold, save_manifold

TINY = (
    "--epochs 1 --fine-epochs 1 --fine-rate 0.05 --filters 6 8 --taps 5 --window 32 --overlap 16 "
    "--quiet"
).split()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions")
    write_series(plan_takes(1.0, seed=2, kinds=["walk", "press_ups"]), motions, rate=30.0)
    return motions


@pytest.fixture(scope="module")
def model(folder, tmp_path_factory):
    """A model that records which takes it was not trained on."""
    file = tmp_path_factory.mktemp("model") / "model.npz"
    assert main(["train", str(folder), "-o", str(file), "--test", "*_01.bvh", *TINY]) == 0
    return file


def run(*argv) -> int:
    return main(["report", *map(str, argv)])


def test_it_writes_a_page_and_a_text(folder, model, tmp_path, capsys):
    out = tmp_path / "new"
    words = ["--data", folder, "-m", model, "-o", out]
    assert run(*words, "--only", "sampling", "lengths") == 0
    captured = capsys.readouterr()
    assert "[2/2]" in captured.err
    assert "claims held" in captured.out
    html, text = ((out / name).read_text() for name in ("report.html", "report.txt"))
    assert html.count('<section id="') == 2
    assert "data:image/png;base64," in html
    assert "| fitted prior " in text
    assert "*_01.bvh" in text
    assert f"NumPy {np.__version__}" in text
    assert sorted(path.name for path in out.iterdir()) == ["report.html", "report.txt"]


def test_an_experiment_that_cannot_be_run_does_not_stop_the_others(folder, model, tmp_path, capsys):
    few = tmp_path / "few"
    few.mkdir()
    for path in sorted(folder.rglob("*.bvh"))[:3]:
        (few / path.name).write_bytes(path.read_bytes())  # without labels.csv
    words = ["--data", few, "-m", model, "-o", tmp_path / "out", "--only"]
    assert run(*words, "interpolation", "lengths", "--json") == 0
    captured = capsys.readouterr()
    assert "could not be run" in captured.err
    printed = json.loads(captured.out)
    lacking, measured = printed["experiments"]
    assert lacking["failure"] and not lacking["claims"]
    assert printed["claims"] == len(measured["claims"]) > 0
    assert printed["held"] == sum(claim["held"] for claim in measured["claims"])
    assert "*_01.bvh" in printed["how"]["test takes"]
    assert "Clips of any length" in (tmp_path / "out" / "report.txt").read_text()


def test_takes_of_the_training_are_refused(folder, model, tmp_path, capsys):
    silent = tmp_path / "silent.npz"
    manifold = load_manifold(model)
    manifold.settings.pop("test")
    save_manifold(manifold, silent)
    out = tmp_path / "out"
    assert run("--data", folder, "-m", silent, "-o", out) == 2
    assert "--test" in capsys.readouterr().err
    assert run("--data", folder, "-m", model, "-o", out, "--test", "*_02.bvh") == 2
    assert "may be ones that it has seen" in capsys.readouterr().err
    assert not out.exists()
    assert run("--data", folder, "-m", silent, "-o", out, "--test", "no_such*") == 2
    assert "holds no take to test" in capsys.readouterr().err
    with pytest.raises(SystemExit) as exit_:
        run("--data", folder, "-m", model, "-o", out, "--only", "nonsense")
    assert exit_.value.code == 2
