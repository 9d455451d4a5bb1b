"""A clip shifted in time: a still one does not move, and a short one is not asked."""

from dataclasses import replace

import numpy as np
import pytest
from numpy_cae.experiments.repair.shift import SHIFTS, shift

from numpy_cae.experiments.comparison.distances import EUCLIDEAN
from numpy_cae.experiments.material import Material


@pytest.fixture(scope="module")
def measured(small_manifold, labelled):
    # One that stands still is added: whenever it is looked at, it looks the same.
    first = labelled.testing[0]
    still = replace(first, positions=np.repeat(first.positions[:1], 90, axis=0))
    return shift(small_manifold, Material([], [*labelled.testing, still]))


def test_what_stands_still_does_not_move(measured):
    for name, moved in measured.moved.items():
        assert moved.shape == (5, len(SHIFTS))
        np.testing.assert_allclose(moved[-1], 0, atol=1e-5)
        assert np.all(measured.itself[name][-1])
        assert np.all(moved[:-1] > 0)


def test_the_share_is_of_the_distance_to_others(measured, small_manifold, labelled):
    x = [
        small_manifold.normalise(small_manifold.features(take.positions)[0])
        for take in labelled.testing
    ]
    x.append(np.repeat(x[0][:1], 90, axis=0))
    x[-1][:, 60:] = 0 * x[-1][:, 60:] + small_manifold.normalise(np.zeros((1, 63)))[:, 60:]
    itself = np.linalg.norm(x[1][:32] - x[1][5:37])
    others = [np.linalg.norm(x[1][:32] - x[n][:32]) for n in (0, 2, 3, 4)]
    share = measured.moved[EUCLIDEAN][1, SHIFTS.index(5)]
    assert share == pytest.approx(itself / np.median(others), rel=0.02)


def test_findings_and_picture(measured, tmp_path):
    for finding in measured.findings():
        assert finding.text().startswith(("held", "not held"))
    assert f"| {SHIFTS[-1]} " in measured.text()
    measured.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_takes_that_are_too_short_are_refused(small_manifold, labelled):
    short = [replace(take, positions=take.positions[:60]) for take in labelled.testing]
    with pytest.raises(ValueError, match="two held-out takes of 72 frames, there are 0"):
        shift(small_manifold, Material([], short))
