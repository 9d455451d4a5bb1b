"""The motion that several tests of this package use."""

import pytest

from data_synth import make_take
from numpy_cae.mocap import body_of


@pytest.fixture(scope="session")
def walk_features(walk_manifold):
    """The features of a walk that the manifold has not seen, (72, 63)."""
    return walk_manifold.features(body_of(make_take("walk", 99, 2.4, 30.0).motion))[0]
