"""`interpolate` and `sample` from the command line."""

from __future__ import annotations

import pytest

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.manifold import save_manifold
from numpy_cae.motion import JOINTS, load_motion, write_bvh


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions")
    for seed, (kind, rate) in enumerate([("walk", 30.0), ("press_ups", 60.0), ("run", 30.0)]):
        take = make_take(kind, seed, seconds=2.0 + seed, rate=rate)
        write_bvh(take.motion, motions / f"{kind}.bvh", unit=0.01)
    return motions


@pytest.fixture(scope="module")
def model(walk_manifold, tmp_path_factory):
    file = tmp_path_factory.mktemp("model") / "model.npz"
    save_manifold(walk_manifold, file)
    return file


def done(*argv) -> None:
    assert main([str(word) for word in argv]) == 0


def message(capsys, *argv) -> str:
    assert main([str(word) for word in argv]) == 2
    error = capsys.readouterr().err
    assert "Traceback" not in error
    return error.strip().splitlines()[-1]


@pytest.mark.parametrize("share", ["0.3", "transition"])
def test_the_result_is_in_the_rig_rate_and_unit_of_the_first(folder, model, tmp_path, share):
    out, gif = tmp_path / "out.bvh", tmp_path / "out.gif"
    first, second = folder / "press_ups.bvh", folder / "walk.bvh"
    words = ["interpolate", first, second, "-m", model, "-o", out, "--share", share, "--gif", gif]
    done(*words)
    made, rig = load_motion(out), load_motion(first)
    assert made.skeleton.names == rig.skeleton.names
    assert (made.rate, made.unit) == (pytest.approx(rig.rate), rig.unit)
    assert made.seconds == pytest.approx(2.0, abs=0.02)  # the walk is the shorter one
    assert gif.read_bytes().startswith(b"GIF")


def test_samples_of_both_priors_are_written_to_one_file_each(folder, model, tmp_path):
    done("sample", "-m", model, "--data", folder, "-o", tmp_path / "a.bvh", "--seconds", 1.5)
    made = load_motion(tmp_path / "a.bvh")
    assert set(made.skeleton.names) == set(JOINTS)
    assert len(made) == 45
    like, gif = folder / "press_ups.bvh", tmp_path / "b.gif"
    argv = ["sample", "-m", model, "--prior", "uniform", "-o", tmp_path / "b.bvh", "--number", 2]
    done(*argv, "--seconds", 1, "--like", like, "--gif", gif)
    for name in ("b_1.bvh", "b_2.bvh"):
        made = load_motion(tmp_path / name)
        assert made.skeleton.names == load_motion(like).skeleton.names
        assert made.rate == pytest.approx(60)
        assert made.seconds == pytest.approx(1.0, abs=0.02)
    assert gif.read_bytes().startswith(b"GIF")


def test_the_same_seed_draws_the_same_motion(folder, model, tmp_path):
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        argv = ["-m", model, "--data", folder, "-o", tmp_path / f"{name}.bvh", "--seed", seed]
        done("sample", *argv, "--seconds", 1)
    a, b, c = ((tmp_path / f"{name}.bvh").read_bytes() for name in "abc")
    assert a == b != c


def test_an_error_is_one_line(folder, model, tmp_path, capsys):
    walk, out = folder / "walk.bvh", tmp_path / "o.bvh"
    assert "--data" in message(capsys, "sample", "-m", model, "-o", out)
    assert "written as .bvh" in message(capsys, "sample", "-m", model, "-o", tmp_path / "o.fbx")
    words = ["interpolate", walk, tmp_path / "no.bvh", "-m", model, "-o", out]
    assert "no.bvh" in message(capsys, *words)
    with pytest.raises(SystemExit) as exit_:
        main(["interpolate", str(walk), str(walk), "-m", str(model), "-o", "x", "--share", "2"])
    assert exit_.value.code == 2
    assert not out.exists()
