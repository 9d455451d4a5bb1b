"""The command `report` on a folder of synthetic takes and a tiny network."""

import numpy as np
import pytest

from data_synth import plan_takes, write_series
from numpy_cae.manifold import load_manifold, save_manifold


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions")
    write_series(plan_takes(1.0, seed=2, kinds=["walk", "press_ups"]), motions, rate=30.0)
    return motions


@pytest.fixture(scope="module")
def model(folder, tmp_path_factory, train):
    """A model that records which takes it was not trained on."""
    return train(folder, tmp_path_factory.mktemp("model") / "model.npz", "--test", "*_01.bvh")


def test_it_writes_a_page_and_a_text(folder, model, tmp_path, capsys, run):
    out = tmp_path / "new"
    words = ["report", "--data", folder, "-m", model, "-o", out]
    run(*words, "--only", "sampling", "interpolation")
    captured = capsys.readouterr()
    assert "[2/2]" in captured.err
    assert "claims confirmed" in captured.out
    html, text = ((out / name).read_text() for name in ("report.html", "report.txt"))
    assert html.count('<section id="') == 2
    assert "data:image/png;base64," in html
    assert "| fitted prior " in text
    assert "*_01.bvh" in text
    assert f"NumPy {np.__version__}" in text
    assert sorted(path.name for path in out.iterdir()) == [
        "report.html",
        "report.json",
        "report.txt",
    ]


def test_an_experiment_that_cannot_be_run_stops_no_other(folder, model, tmp_path, capsys, run):
    few = tmp_path / "few"
    few.mkdir()
    for path in sorted(folder.rglob("*.bvh"))[:3]:
        (few / path.name).write_bytes(path.read_bytes())  # without labels.csv
    words = ["report", "--data", few, "-m", model, "-o", tmp_path / "out", "--only"]
    run(*words, "interpolation", "sampling")
    captured = capsys.readouterr()
    assert "interpolation: Could not be run: " in captured.err
    assert "sampling: " in captured.err and "claims confirmed\n" in captured.out
    text = (tmp_path / "out" / "report.txt").read_text()
    assert "Sampling from a prior" in text and "test takes: *_01.bvh" in text


def test_takes_of_the_training_are_refused(folder, model, tmp_path, error_of):
    silent, out = tmp_path / "silent.npz", tmp_path / "out"
    manifold = load_manifold(model)
    manifold.settings.pop("test")
    save_manifold(manifold, silent)
    for words, message in (
        (["-m", silent], "--test"),
        (["-m", model, "--test", "*_02.bvh"], "may be ones that it has seen"),
        (["-m", silent, "--test", "no_such*"], "holds no take to test"),
    ):
        assert message in error_of("report", "--data", folder, "-o", out, *words)
        assert not out.exists()
