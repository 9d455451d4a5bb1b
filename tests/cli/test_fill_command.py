"""`numpy-cae fill` from the command line."""

from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import write_acclaim

from data_synth import make_take
from numpy_cae.cli import main
from numpy_cae.manifold import save_manifold
from numpy_cae.motion import load_motion, write_bvh


@pytest.fixture(scope="module")
def take():
    return make_take("walk", 0, seconds=1.0, rate=120.0).motion


@pytest.fixture(scope="module")
def folder(take, untrained_manifold, tmp_path_factory):
    """A file in inches, the same person for Acclaim, and a model that learned nothing."""
    folder = tmp_path_factory.mktemp("fill")
    write_bvh(take, folder / "walk.bvh", unit=0.0254)
    write_acclaim(take, folder / "walk.amc")
    one = replace(take, rotations=take.rotations[:1], translations=take.translations[:1])
    write_bvh(one, folder / "one.bvh", unit=0.0254)
    save_manifold(untrained_manifold, folder / "model.npz")
    return folder


def fill(folder, file, output, *argv):
    return ["fill", folder / file, "-m", folder / "model.npz", "-o", output, *argv]


@pytest.mark.parametrize("file", ["walk.bvh", "walk.amc", "one.bvh"])
@pytest.mark.parametrize("what", [("--joint", "left_wrist"), ("--keyframes", 15)])
def test_the_rig_the_rate_and_the_unit_come_back(folder, tmp_path, file, what, capsys, run):
    gif = tmp_path / "filled.gif"
    run(*fill(folder, file, tmp_path / "filled.bvh", *what, "--gif", gif))
    came, filled = load_motion(folder / file), load_motion(tmp_path / "filled.bvh")
    assert set(filled.skeleton.names) == set(came.skeleton.names)
    assert (filled.rate, len(filled)) == (came.rate, len(came))
    assert filled.unit == pytest.approx(came.unit)
    assert f"{len(came)} frames at 120 a second, 31 joints" in capsys.readouterr().out
    assert gif.read_bytes().startswith(b"GIF")


def test_known_joints_and_keyframes_read_back_where_they_were(folder, tmp_path, run):
    came = load_motion(folder / "walk.bvh").positions()
    run(*fill(folder, "walk.bvh", tmp_path / "k.bvh", "--keyframes", 15))
    filled = load_motion(tmp_path / "k.bvh").positions()
    np.testing.assert_allclose(filled[::15], came[::15], atol=1e-5)
    run(*fill(folder, "walk.bvh", tmp_path / "j.bvh", "--joint", "right_elbow"))
    filled = load_motion(tmp_path / "j.bvh")
    for joint in ("root", "rhumerus", "rwrist", "head", "ltoes"):
        place = filled.skeleton.index(joint)
        np.testing.assert_allclose(filled.positions()[:, place], came[:, place], atol=1e-5)
    elbow = filled.skeleton.index("rradius")
    assert np.abs(filled.positions()[:, elbow] - came[:, elbow]).max() > 0.001


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (("--joint", "nose"), "no joint 'nose', expected one of hips, "),
        (("--joint", "left_hip"), "left_hip is fixed"),
    ],
)
def test_an_error_names_other_joints(folder, tmp_path, argv, message, error_of):
    line = error_of(*fill(folder, "walk.bvh", tmp_path / "x.bvh", *argv))
    assert message in line
    assert "left_wrist" in line
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("argv", [(), ("--joint", "head", "--keyframes", 15), ("--keyframes", 0)])
def test_invalid_options_exit_with_2(folder, tmp_path, argv):
    with pytest.raises(SystemExit) as exit_:
        main([str(word) for word in fill(folder, "walk.bvh", tmp_path / "x.bvh", *argv)])
    assert exit_.value.code == 2


def test_fit_fills_a_gap_and_keeps_the_rest(folder, tmp_path, run, error_of):
    came, out = load_motion(folder / "walk.bvh"), tmp_path / "f.bvh"
    words = ["--joint", "left_wrist", "--frames", 40, 80, "--fit"]
    run(*fill(folder, "walk.bvh", out, *words, "--data", folder))
    moved = np.abs(load_motion(out).positions() - came.positions()).max(axis=(1, 2))
    assert moved[np.r_[:40, 81:120]].max() < 1e-4  # the digits of a file
    assert moved[45:76].max() > 1e-3
    for wrong, message in (
        (["--keyframes", 9, "--fit"], "--fit requires --joint"),
        (["--joint", "left_wrist", "--frames", 80, 400], "the motion has 0 to 119"),
        (["--joint", "left_wrist", "--data", folder], "--data requires --fit"),
    ):
        assert message in error_of(*fill(folder, "walk.bvh", out, *wrong))
