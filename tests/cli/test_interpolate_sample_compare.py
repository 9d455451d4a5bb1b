"""`interpolate`, `sample` and `compare` from the command line."""

import csv
import shutil

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.mocap import body_of, load_motion, write_bvh
from numpy_cae.motion import JOINTS


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions")
    for seed, (kind, rate) in enumerate([("walk", 30.0), ("press_ups", 60.0), ("run", 30.0)]):
        take = make_take(kind, seed, seconds=2.0 + seed, rate=rate)
        write_bvh(take.motion, motions / f"{kind}.bvh", unit=0.01)
    return motions


@pytest.mark.parametrize("share", ["0.3", "transition"])
def test_the_result_is_in_the_rig_rate_and_unit_of_the_first(folder, model, tmp_path, share, run):
    out = tmp_path / "out.bvh"
    first, second = folder / "press_ups.bvh", folder / "walk.bvh"
    words = ["interpolate", first, second, "-m", model, "-o", out, "--share", share, "--html"]
    run(*words)
    assert "between" in out.with_suffix(".html").read_text(encoding="utf-8")
    made, rig = load_motion(out), load_motion(first)
    assert made.skeleton.names == rig.skeleton.names
    assert (made.rate, made.unit) == (pytest.approx(rig.rate), rig.unit)
    assert made.seconds == pytest.approx(2.0, abs=0.02)  # the walk is the shorter one
    paths = [body_of(motion)[:, 0, ::2] for motion in (made, rig, load_motion(second))]
    hips, *sources = (np.linalg.norm(np.diff(path, 2, axis=0), axis=1).max() for path in paths)
    assert hips <= max(sources)


def test_samples_of_both_priors_are_written_to_one_file_each(folder, model, tmp_path, run):
    run("sample", "-m", model, "--data", folder, "-o", tmp_path / "a.bvh", "--seconds", 1.5)
    made = load_motion(tmp_path / "a.bvh")
    assert set(made.skeleton.names) == set(JOINTS)
    assert len(made) == 45
    like = folder / "press_ups.bvh"
    argv = ["sample", "-m", model, "-o", tmp_path / "b.bvh", "--number", 2]
    run(*argv, "--seconds", 1, "--like", like, "--html")
    for name in ("b_1.bvh", "b_2.bvh"):
        made = load_motion(tmp_path / name)
        assert made.skeleton.names == load_motion(like).skeleton.names
        assert made.rate == pytest.approx(60)
        assert made.seconds == pytest.approx(1.0, abs=0.02)


@pytest.fixture(scope="module")
def nested(folder, tmp_path_factory):
    nested = tmp_path_factory.mktemp("nested")
    (nested / "more").mkdir()
    for name, kind in (("a", "walk"), ("more/b", "press_ups"), ("more/a", "run")):
        shutil.copy(folder / f"{kind}.bvh", nested / f"{name}.bvh")
    return nested


def test_a_folder_becomes_a_matrix_and_a_picture(nested, model, tmp_path, capsys, run):
    table, picture = tmp_path / "matrix.csv", tmp_path / "matrix.png"
    run("compare", nested, "-m", model, "-o", table, "--picture", picture)
    with open(table, newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header == ["", "a.bvh", "more/a.bvh", "more/b.bvh"]
    assert [row[0] for row in rows] == header[1:]
    matrix = np.array([row[1:] for row in rows], dtype=float)
    np.testing.assert_array_equal(matrix, matrix.T)
    np.testing.assert_array_equal(np.diag(matrix), 0)
    assert matrix[0, 1] > 0
    nearest = header[1 + np.argmin(np.where(np.eye(3), np.inf, matrix)[0])]
    assert capsys.readouterr().out.startswith(f"a.bvh: nearest is {nearest}, G = ")
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["matrix.csv", "matrix.png"]


def test_two_files_of_one_name_are_told_apart(nested, model, capsys, run):
    one, other = nested / "a.bvh", nested / "more" / "a.bvh"
    run("compare", one, other, "-m", model)
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith(f"{one}: nearest is {other}, G = ")
    assert first.split()[-1] == second.split()[-1]
