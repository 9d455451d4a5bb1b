"""The commands as a person types them: what they write, and what they say when they cannot."""

import json
from dataclasses import asdict

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cli import demo, main
from numpy_cae.manifold import load_manifold
from numpy_cae.motion import load_motion, write_bvh
from numpy_cae.training import Schedule, Stage

TINY = (
    "--epochs 1 --fine-epochs 2 --fine-rate 0.05 --filters 6 8 --taps 5 --window 32 --overlap 16 "
    "--quiet"
).split()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions")
    for seed in range(4):
        take = make_take("walk", seed, seconds=3.0, rate=30.0)
        write_bvh(take.motion, motions / f"walk_{seed}.bvh", unit=0.01)
    return motions


@pytest.fixture(scope="module")
def model(folder, tmp_path_factory):
    file = tmp_path_factory.mktemp("model") / "model.npz"
    assert main(["train", str(folder), "-o", str(file), *TINY]) == 0
    return file


def said(capsys, *argv):
    """Run a command that must fail: its one line on standard error."""
    assert main([str(word) for word in argv]) == 2
    captured = capsys.readouterr()
    lines = captured.err.strip().splitlines()
    assert lines[-1].startswith(f"numpy-cae {argv[0]}: ")
    assert "Traceback" not in captured.err
    return lines[-1]


def test_train_measures_on_the_takes_kept_out(folder, tmp_path, capsys):
    file, picture = tmp_path / "m.npz", tmp_path / "figure.png"
    argv = ["train", folder, "-o", file, "--test", "*_3.bvh", "--picture", picture, *TINY]
    assert main([str(word) for word in argv]) == 0
    captured = capsys.readouterr()
    assert "3 takes to train on" in captured.err
    assert "centimetres (4)" in captured.err
    assert "| the network " in captured.out
    assert picture.read_bytes().startswith(b"\x89PNG")
    settings = load_manifold(file).settings
    assert settings["takes"] == 3
    assert settings["schedule"]["fine_tuning"] == asdict(Stage(2, 0.05, alpha=0.0))


def test_several_folders_and_patterns_are_kept_with_the_model(folder, tmp_path, capsys):
    other, file = tmp_path / "other", tmp_path / "m.npz"
    other.mkdir()
    for name in ("walk_0.bvh", "walk_1.bvh", "walk_2.bvh"):
        (other / name).write_bytes((folder / name).read_bytes())
    argv = ["train", folder, other, "-o", file, "--test", "*_3.bvh", "*_2.bvh", *TINY]
    argv += ["--fine-zeroed", "0.1", "0.9", "--fine-rescale", "--fine-batch", "4"]
    argv += ["--fine-momentum", "0.5"]
    assert main([str(word) for word in argv]) == 0
    assert "4 takes to train on" in capsys.readouterr().err
    manifold = load_manifold(file)
    assert manifold.settings["test"] == ["*_3.bvh", "*_2.bvh"]
    assert manifold.settings["folders"] == [
        {"name": folder.name, "files": 4, "test": 2},
        {"name": "other", "files": 3, "test": 1},
    ]
    assert manifold.settings["schedule"]["fine_tuning"]["zeroed"] == [0.1, 0.9]
    assert manifold.settings["schedule"]["fine_tuning"]["momentum"] == 0.5
    assert manifold.rescales


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--zeroed", "0.9", "0.1"], "the lowest and the highest"),
        (["--fine-zeroed", "0.1", "0.2", "0.3"], "the lowest and the highest"),
        (["--fine-zeroed", "0.1", "1", "--fine-rescale"], "below 1"),
        (["--test", "*_3.bvh", "x*"], "no file matches 'x*'"),
    ],
)
def test_train_says_what_is_wrong_with_its_options(folder, tmp_path, capsys, options, complaint):
    assert complaint in said(capsys, "train", folder, "-o", tmp_path / "m.npz", *options)


def test_training_twice_gives_the_same_bits(folder, model, tmp_path):
    again = tmp_path / "again.npz"
    assert main(["train", str(folder), "-o", str(again), *TINY]) == 0
    with np.load(model) as one, np.load(again) as two:
        for name in set(one.files) - {"settings"}:
            np.testing.assert_array_equal(one[name], two[name])
        settings = [json.loads(str(each["settings"])) for each in (one, two)]
    # How long each stage took is kept with the model, and no two runs take equally long.
    times = [each.pop("seconds") for each in settings]
    assert settings[0] == settings[1]
    assert list(times[0]) == list(times[1]) == list(settings[0]["losses"])


def test_repair_writes_the_rig_that_came_in(folder, model, tmp_path, capsys):
    fixed, gif = tmp_path / "fixed.bvh", tmp_path / "fixed.gif"
    argv = ["repair", folder / "walk_0.bvh", "-m", model, "-o", fixed, "--gif", gif]
    assert main([str(word) for word in argv]) == 0
    captured = capsys.readouterr()
    assert "centimetres" in captured.err
    assert "90 frames at 30 a second, 31 joints" in captured.out
    before, after = load_motion(folder / "walk_0.bvh"), load_motion(fixed)
    assert after.skeleton.names == before.skeleton.names
    assert len(after) == len(before)
    assert after.unit == pytest.approx(0.01)
    assert gif.read_bytes().startswith(b"GIF")


def test_show_draws_a_strip_and_a_gif(folder, tmp_path):
    assert main(["show", str(folder / "walk_1.bvh"), "-o", str(tmp_path / "new")]) == 0
    names = sorted(path.name for path in (tmp_path / "new").iterdir())
    assert names == ["walk_1.gif", "walk_1.png"]


def test_the_demo_makes_all_that_it_promises(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(demo, "TAKES", 6 * len(demo.KINDS))
    monkeypatch.setattr(demo, "SECONDS", 1.5)
    monkeypatch.setattr(demo, "SCHEDULE", Schedule(Stage(epochs=1), Stage(1, 0.05, 0.9, 0.0)))
    assert main(["demo", "-o", str(tmp_path / "demo"), "--quiet"]) == 0
    out = capsys.readouterr().out
    for method in ("doing nothing", "PCA on frames", "PCA on windows", "the network"):
        assert f"| {method} " in out
    made = {path.name for path in (tmp_path / "demo").iterdir()}
    assert made == {
        "motions",
        "model.npz",
        "figure_1.png",
        "figure_1.gif",
        "corrupted.bvh",
        "projected.bvh",
        "truth.bvh",
    }
    assert len(load_motion(tmp_path / "demo" / "projected.bvh")) == 45


def test_files_that_are_missing_or_damaged(folder, model, tmp_path, capsys):
    broken = tmp_path / "broken.bvh"
    lines = (folder / "walk_0.bvh").read_text().splitlines()
    broken.write_text("\n".join(lines[:-3]))
    fixed = tmp_path / "fixed.bvh"
    assert "Frames" in said(capsys, "repair", broken, "-m", model, "-o", fixed)
    assert "no such file" in said(capsys, "repair", tmp_path / "no.bvh", "-m", model, "-o", fixed)
    assert "no such folder" in said(capsys, "train", tmp_path / "no", "-o", tmp_path / "m.npz")
    (tmp_path / "empty").mkdir()
    assert "no motion file" in said(capsys, "train", tmp_path / "empty", "-o", tmp_path / "m.npz")
    assert "broken.bvh" in said(capsys, "show", broken, "-o", tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["broken.bvh", "empty"]


def test_models_and_outputs_that_cannot_be(folder, model, tmp_path, capsys):
    walk = folder / "walk_0.bvh"
    fixed = tmp_path / "fixed.bvh"
    assert "No such file" in said(capsys, "repair", walk, "-m", tmp_path / "x.npz", "-o", fixed)
    assert "not a model" in said(capsys, "repair", walk, "-m", walk, "-o", fixed)
    assert "written as .bvh" in said(capsys, "repair", walk, "-m", model, "-o", tmp_path / "x.fbx")
    nowhere = tmp_path / "no" / "fixed.bvh"
    assert "no folder" in said(capsys, "repair", walk, "-m", model, "-o", nowhere)
    assert "no folder" in said(capsys, "train", folder, "-o", nowhere.with_suffix(".npz"), *TINY)
    assert not list(tmp_path.iterdir())


def test_a_rig_that_lacks_joints_and_one_with_a_mapping(folder, model, tmp_path, capsys):
    text = (folder / "walk_0.bvh").read_text()
    strange = tmp_path / "strange.bvh"
    strange.write_text(text.replace("JOINT lwrist", "JOINT paw"))
    fixed = tmp_path / "fixed.bvh"
    message = said(capsys, "repair", strange, "-m", model, "-o", fixed)
    assert "strange.bvh" in message
    assert "left_wrist" in message
    mapping = tmp_path / "rig.json"
    mapping.write_text(json.dumps({"left_wrist": "paw"}))
    argv = ["repair", strange, "-m", model, "-o", fixed, "--mapping", mapping]
    assert main([str(word) for word in argv]) == 0


def test_a_pattern_that_keeps_nothing_or_everything(folder, tmp_path, capsys):
    out = tmp_path / "m.npz"
    assert "none is left to test" in said(capsys, "train", folder, "-o", out, "--test", "x*")
    assert "none is left to train" in said(capsys, "train", folder, "-o", out, "--test", "*")
    assert "--test" in said(capsys, "train", folder, "-o", out, "--picture", tmp_path / "p.png")


def test_windows_that_do_not_suit_the_network(folder, tmp_path, capsys):
    out = tmp_path / "m.npz"
    assert "multiple of 8" in said(capsys, "train", folder, "-o", out, "--window", 150)
    assert "overlap is 160" in said(capsys, "train", folder, "-o", out, "--overlap", 160)


@pytest.mark.parametrize(
    "argv",
    [
        [],
        ["nonsense"],
        ["train", "x", "-o", "y", "--epochs", "-1"],
        ["train", "x", "-o", "y", "--taps", "4"],
        ["train", "x", "-o", "y", "--zeroed", "1.5"],
        ["train", "x", "-o", "y", "--bound", "1"],
        ["train", "x", "-o", "y", "--rate", "nan"],
        ["train", "x", "-o", "y", "--fine-momentum", "1"],
        ["show", "x", "--unit", "0"],
    ],
)
def test_words_that_make_no_sense_exit_with_2(argv, capsys):
    with pytest.raises(SystemExit) as exit_:
        main(argv)
    assert exit_.value.code == 2
    assert "Traceback" not in capsys.readouterr().err
