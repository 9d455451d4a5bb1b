"""Every way to compare motions says what it is called, and has the right diagonal."""

import numpy as np
import pytest

from numpy_cae.experiments.comparison.distances import (
    EQUATION_4,
    EUCLIDEAN,
    all_distances,
    equation_4,
    euclidean,
)
from numpy_cae.manifold import G, hidden_units


@pytest.fixture(scope="module")
def clips(small_manifold, labelled):
    return [small_manifold.features(take.positions)[0] for take in labelled.testing]


def test_among_themselves_all_are_symmetric_and_zero_on_the_diagonal(small_manifold, clips):
    ways = all_distances(small_manifold, clips)
    assert len({way.name for way in ways}) == len(ways)
    for way in ways:
        own = way.between(clips)
        assert own.shape == (4, 4)
        np.testing.assert_allclose(own, own.T, atol=1e-6)
        np.testing.assert_allclose(np.diag(own), 0, atol=1e-5)
        assert np.all(own[~np.eye(4, dtype=bool)] > 0)
        np.testing.assert_allclose(way.between(clips, clips[:3]), own[:, :3], atol=1e-6)


def test_equation_4_is_the_root_of_g(small_manifold, clips):
    units = [hidden_units(small_manifold, clip) for clip in clips]
    between = equation_4(small_manifold).between(clips)
    assert between[0, 1] ** 2 == pytest.approx(G(units[0], units[1]), rel=1e-5)
    assert EQUATION_4 != EUCLIDEAN


def test_windows_are_compared_frame_by_frame_and_the_nearest_pair_counts(small_manifold, clips):
    whole, shifted = clips[0][:64], clips[0][16:48]
    x = small_manifold.normalise(clips[0])
    way = euclidean(small_manifold)
    # Windows of 32 start every 16 frames, so one of the whole clip's is the shifted one.
    assert way.between([whole], [shifted])[0, 0] == 0
    other = way.between([clips[0][:32]], [clips[0][8:40]])[0, 0]
    assert other == pytest.approx(np.linalg.norm(x[:32] - x[8:40]), rel=1e-5)
