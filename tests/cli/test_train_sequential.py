"""`numpy-cae train --model sequential`."""

import numpy as np

from numpy_cae.evaluation import tables
from numpy_cae.manifold import load_manifold

NETWORK = "--hidden 6 --latent 3 --epochs 1 --steps 2 --batch 4 --quiet".split()
TINY = ["--model", "sequential", *NETWORK]


def test_it_trains_and_measures(walks, tmp_path, capsys, monkeypatch, run):
    monkeypatch.setattr(tables, "PCA_CLIPS", 200)
    file = tmp_path / "seq.npz"
    run("train", walks, "-o", file, "--test", "*_2.bvh", *TINY)
    captured = capsys.readouterr()
    assert "3 takes to train on" in captured.err
    assert "| walking: the network" in captured.out
    manifold = load_manifold(file)
    assert (manifold.network.hidden, manifold.network.latent) == (6, 3)
    assert manifold.settings["schedule"]["steps"] == 2


def test_it_trains_on_exponential_map_text(tmp_path, run):
    rng = np.random.default_rng(0)
    for number in range(2):
        rows = np.cumsum(rng.normal(0, 0.02, (300, 117)), axis=0)
        np.savetxt(tmp_path / f"walking_{number}.txt", rows, delimiter=",")
    run("train", tmp_path, "-o", tmp_path / "seq.npz", *TINY)
    assert load_manifold(tmp_path / "seq.npz").settings["motions"] == 2
