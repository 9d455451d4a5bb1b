"""`load_windows`: all files, a pattern, and a limit of minutes."""

import pytest

from data_synth import make_take
from numpy_cae.motion import MotionFileError, load_windows, write_bvh


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    motions = tmp_path_factory.mktemp("motions")
    for seed, kind in enumerate(["walk", "walk", "run"]):
        take = make_take(kind, seed, seconds=3.0, rate=30.0)
        write_bvh(take.motion, motions / f"{kind}_{seed}.bvh", unit=0.01)
    return motions


def test_every_window_of_every_file(folder):
    windows = load_windows(folder, length=32, overlap=16)
    assert windows.features.shape[1:] == (32, 63)
    assert len(windows.features) == len(windows.real) == len(windows.takes)
    assert sorted(set(windows.takes)) == [0, 1, 2]
    assert windows.real.all()


def test_a_pattern_and_a_limit(folder):
    assert set(load_windows(folder, "walk*", length=32, overlap=16).takes) == {0, 1}
    assert set(load_windows(folder, minutes=0.01, length=32, overlap=16).takes) == {0}
    with pytest.raises(MotionFileError, match="no motion file matches"):
        load_windows(folder, "swim*")
