"""`numpy-cae train --model sequential` and `numpy-cae study` as a person types them."""

import json

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.manifold import load_manifold
from numpy_cae.motion import write_bvh

TINY = (
    "--model sequential --hidden 6 --latent 3 --epochs 1 --steps 2 --batch 4 "
    "--quiet"
).split()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions") / "walking"
    motions.mkdir()
    for seed in range(3):
        take = make_take("walking", seed, seconds=3.0, rate=25.0)
        write_bvh(take.motion, motions / f"walk_{seed}.bvh", unit=0.01)
    return motions


def test_it_trains_measures_and_draws(folder, tmp_path, capsys):
    file, picture = tmp_path / "seq.npz", tmp_path / "samples.png"
    argv = ["train", folder, "-o", file, "--test", "*_2.bvh", "--picture", picture, *TINY]
    assert main([str(word) for word in argv]) == 0
    captured = capsys.readouterr()
    assert "2 motions to train on" in captured.err
    assert "| walking: the network" in captured.out
    assert picture.read_bytes().startswith(b"\x89PNG")
    manifold = load_manifold(file)
    assert (manifold.network.hidden, manifold.network.latent) == (6, 3)
    assert manifold.settings["schedule"]["steps"] == 2


def test_exponential_map_text_is_learned_from(tmp_path):
    rng = np.random.default_rng(0)
    for number in range(2):
        rows = np.cumsum(rng.normal(0, 0.02, (300, 117)), axis=0)
        np.savetxt(tmp_path / f"walking_{number}.txt", rows, delimiter=",")
    argv = ["train", str(tmp_path), "-o", str(tmp_path / "seq.npz"), *TINY]
    assert main(argv) == 0
    assert load_manifold(tmp_path / "seq.npz").settings["motions"] == 2


def test_a_study_writes_its_claims_pictures_and_models(folder, tmp_path, capsys, monkeypatch):
    changes = {"reconstruction.PCA_CLIPS": 200, "uses.PAIRS": 10, "regulariser.REPEATS": 1}
    for name, fewer in changes.items():
        monkeypatch.setattr(f"numpy_cae.experiments.sequences.{name}", fewer)
    argv = ["study", "--data", folder, "--test", "*_2.bvh", "-o", tmp_path / "study", *TINY[2:]]
    assert main([*(str(word) for word in argv), "--json"]) == 0
    tables = json.loads(capsys.readouterr().out)
    said = (tmp_path / "study/study.txt").read_text(encoding="utf-8")
    assert "held: " in said and "teacher-forced" in said
    assert all(table["title"] in said and table["tables"] for table in tables)
    claims = [claim for table in tables for claim in table["claims"]]
    assert said.count("held: ") == len(claims)
    assert all(claim["sentence"] in said and claim["figures"] in said for claim in claims)
    written = {path.name for path in (tmp_path / "study").iterdir()}
    assert {"figure_2.png", "walking_fitted.png", "walking_fitted.gif", "walking.npz"} <= written
    assert {"walking_uses.png", "walking_uses.gif"} <= written


def test_a_study_needs_something_to_test_on(folder, tmp_path, capsys):
    assert main(["study", "--data", str(folder), "-o", str(tmp_path), *TINY[2:]]) == 2
    assert "leaves nothing of walking to test" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["--window", "64", *TINY], "--window is not an option of the sequential model"),
        (["--latent", "3"], "--latent is not an option of the convolutional model"),
        (["--test", "*.txt", *TINY], "no file matches *.txt"),
        (["--test", "*", *TINY], "every file matches *"),
        (["--frames", "500", *TINY], "as long as a clip of 500 frames"),
    ],
)
def test_what_does_not_fit_is_said_in_one_line(folder, tmp_path, capsys, argv, message):
    assert main(["train", str(folder), "-o", str(tmp_path / "seq.npz"), *argv]) == 2
    said = capsys.readouterr().err.strip().splitlines()
    assert said[-1].startswith("numpy-cae train: ") and message in said[-1]
    assert not (tmp_path / "seq.npz").exists()
