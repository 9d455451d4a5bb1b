"""The command `report` on a folder of synthetic takes and a tiny network."""

import json

import numpy as np
import pytest

from data_synth import plan_takes, write_series
from numpy_cae.cli import main
from numpy_cae.manifold import load_manifold


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions")
    write_series(plan_takes(1.0, seed=2, kinds=["walk", "press_ups"]), motions, rate=30.0)
    return motions


@pytest.fixture(scope="module")
def model(folder, tmp_path_factory, train):
    """A model that records which takes it was not trained on."""
    return train(folder, tmp_path_factory.mktemp("model") / "model.npz", "--test", "*_01.bvh")


def test_it_writes_its_files_and_an_experiment_that_cannot_be_run_stops_no_other(
    folder, model, tmp_path, capsys, run
):
    few, out = tmp_path / "few", tmp_path / "new"
    few.mkdir()
    for path in sorted(folder.rglob("*.bvh"))[:3]:
        (few / path.name).write_bytes(path.read_bytes())  # without labels.csv
    words = ["report", "--data", few, "-m", model, "-o", out]
    run(*words, "--only", "interpolation", "filling_in")
    captured = capsys.readouterr()
    assert "interpolation: Could not be run: " in captured.err and "[2/2]" in captured.err
    assert "claims confirmed\n" in captured.out
    html, data = ((out / f"report.{suffix}").read_text() for suffix in ("html", "json"))
    assert html.count('<section id="') == 2
    assert "data:image/png;base64," in html
    assert "the network" in html and "*_01.bvh" in html and f"NumPy {np.__version__}" in html
    assert set(json.loads(data)["results"]) == {"interpolation", "filling_in"}
    assert len(list(out.iterdir())) == 2
    assert main([*map(str, words), "--only", "interpolation"]) == 2  # nothing could be run


def test_takes_of_the_training_are_refused(folder, model, tmp_path, error_of):
    silent, out = tmp_path / "silent.npz", tmp_path / "out"
    manifold = load_manifold(model)
    manifold.settings.pop("test")
    manifold.save(silent)
    for words, message in (
        (["-m", silent], "--test"),
        (["-m", model, "--test", "*_02.bvh"], "may be ones that it has seen"),
        (["-m", silent, "--test", "no_such*"], "holds no take to test"),
    ):
        assert message in error_of("report", "--data", folder, "-o", out, *words)
        assert not out.exists()
