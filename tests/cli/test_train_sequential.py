"""`numpy-cae train --model sequential` and `numpy-cae study`."""

import re

import numpy as np

from numpy_cae.manifold import load_manifold

NETWORK = "--hidden 6 --latent 3 --epochs 1 --steps 2 --batch 4 --quiet".split()
TINY = ["--model", "sequential", *NETWORK]


def test_it_trains_and_measures(walks, tmp_path, capsys, run):
    file = tmp_path / "seq.npz"
    run("train", walks, "-o", file, "--test", "*_2.bvh", *TINY)
    captured = capsys.readouterr()
    assert "3 motions to train on" in captured.err
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


def test_a_study_writes_its_claims_pictures_and_models(walks, tmp_path, capsys, monkeypatch, run):
    sizes = {"sequential.PCA_CLIPS": 200, "samples.SAMPLES": 20}
    for name, fewer in {**sizes, "sequential.REPEATS": 1}.items():
        monkeypatch.setattr(f"numpy_cae.experiments.sequences.{name}", fewer)
    out = tmp_path / "study"
    options = ["--test", "*_2.bvh", *NETWORK[:-1], "--frames", 20]
    run("study", "--data", walks, "-o", out, *options)
    said, page = ((out / f"study.{kind}").read_text(encoding="utf-8") for kind in ("txt", "html"))
    assert page.count("confirmed</span>") > said.count("confirmed:")  # and in the summary
    printed = capsys.readouterr()
    assert printed.out == said and "walking, λ = 0: sequences, epoch 1/1" in printed.err
    assert len(re.findall("^(not )?confirmed: .* Measured: ", said, re.MULTILINE)) > 3
    written = {path.name for path in out.iterdir()}
    assert {"figure_2.png", "walking_fitted.png", "walking_fitted.html", "walking.npz"} <= written
