"""The motion that several tests of this package use."""

import pytest

from data_synth import make_take


@pytest.fixture(scope="session")
def walk_features(walk_manifold):
    """The features of a walk that the manifold has not seen, (72, 63)."""
    return walk_manifold.body(make_take("walk", 99, 2.4, 30.0).motion).features
