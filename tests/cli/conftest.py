"""Fixtures of the command line's tests: a folder of walks, a tiny training."""

import pytest

from data_synth import make_take
from numpy_cae.mocap import write_bvh

TINY = "--epochs 2 --rate 0.05 --window 32 --filters 6 8 --quiet".split()


@pytest.fixture(scope="session")
def walks(tmp_path_factory):
    """A folder of four walks, walk_0.bvh to walk_3.bvh, each of 90 frames at 30 a second."""
    folder = tmp_path_factory.mktemp("motions") / "walking"
    folder.mkdir()
    for seed in range(4):
        take = make_take("walk", seed, seconds=3.0, rate=30.0)
        write_bvh(take.motion, folder / f"walk_{seed}.bvh", unit=0.01)
    return folder


@pytest.fixture
def few_windows(monkeypatch):
    """`train` and `demo` complete two windows of the test takes, which takes them most time."""
    monkeypatch.setattr("numpy_cae.evaluation.tables.WITH_MASK", 2)


@pytest.fixture(scope="session")
def train(run):
    """Train a tiny convolutional model on one folder or a list of them, with more options."""

    def train(folders, out, *options):
        folders = folders if isinstance(folders, list) else [folders]
        run("train", *folders, "-o", out, *TINY, *options)
        return out

    return train


@pytest.fixture(scope="session")
def model(walks, tmp_path_factory, train):
    """A tiny convolutional model of the walks; walk_3.bvh is for testing."""
    return train(walks, tmp_path_factory.mktemp("model") / "model.npz", "--test", "*_3.bvh")
