"""Fixtures and settings of all tests."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

settings.register_profile("quick", max_examples=20, deadline=None)
settings.register_profile("thorough", max_examples=1000, deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "quick"))


@pytest.fixture
def counted(capsys):
    """Print what a thorough test has tried, whether or not output is captured."""

    def counted(text: str) -> None:
        with capsys.disabled():
            print(f"\n{text}")

    return counted


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """The folder of real motion files; where there is none, the test is skipped."""
    beside = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("NUMPY_CAE_DATA", beside))
    if not (folder / "bandai").is_dir():
        pytest.skip(f"no real motion files in {folder}; set NUMPY_CAE_DATA to where they are")
    return folder


@pytest.fixture(scope="session")
def walk_manifold():
    """A small manifold trained on fourteen walks."""
    from data_synth import make_take
    from numpy_cae.manifold import learn_manifold
    from numpy_cae.motion import body_of
    from numpy_cae.training import Schedule, Stage

    takes = [body_of(make_take("walk", seed, 2.0, 30.0).motion) for seed in range(14)]
    schedule = Schedule(layer=Stage(epochs=8), fine_tuning=Stage(12, 0.1, 0.9, 0.0))
    return learn_manifold(
        takes, schedule, window=32, overlap=16, filters=(16, 24), taps=5, show_progress=False
    )


@pytest.fixture(scope="session")
def untrained_manifold():
    """A manifold of random weights about the mean pose of one walk."""
    from data_synth import make_take
    from numpy_cae.manifold import MotionManifold
    from numpy_cae.models import ConvAutoencoder
    from numpy_cae.motion import body_of, bone_lengths

    body = body_of(make_take("walk", 0, 2.0, 30.0).motion)
    network = ConvAutoencoder(filters=(8, 8), taps=5, rng=np.random.default_rng(0))
    found = MotionManifold(network, np.zeros(63), np.full(63, 0.25), bone_lengths(body))
    found.mean_pose = found.features(body)[0].mean(axis=0)
    return found
