"""Descents along the manifold get where they should: lengths exact, feet still, holes filled."""

import numpy as np
import pytest
from numpy_cae.manifold.geodesic import energy
from numpy_cae.manifold.observed import started

from data_synth import make_take
from numpy_cae.baselines import interpolate_linearly
from numpy_cae.manifold import (
    Pins,
    constraints,
    geodesic,
    geodesic_lengths,
    geodesic_matrix,
    interpolate,
    learn_manifold,
    poses_of,
    project_constrained,
    project_observed,
)
from numpy_cae.manifold.interpolate import way_between
from numpy_cae.measures import position_error
from numpy_cae.motion import JOINTS, body_of, features_to_positions, joint_slice
from numpy_cae.motion.contacts import find_contacts
from numpy_cae.training import Schedule, Stage
from numpy_cae.verify import check_gradients


@pytest.fixture(scope="module")
def trained():
    """A small manifold of walks, and the features of one that it did not see."""
    takes = [
        body_of(make_take("walk", seed=seed, seconds=6, rate=30).motion) for seed in range(6)
    ]
    schedule = Schedule(Stage(4, 0.5, 0.9, 0.0), Stage(6, 0.1, 0.9, 0.0))
    manifold = learn_manifold(
        takes[1:], schedule, filters=(16, 24), window=64, overlap=32, show_progress=False
    )
    features, start = manifold.features(takes[0][:70])
    return manifold, features, start


def test_a_constrained_projection_keeps_what_it_should(trained):
    manifold, features, start = trained
    plain = manifold.project(features)
    contacts = find_contacts(features_to_positions(features, start), 30.0)
    assert 0.2 < contacts.mean() < 0.95
    kept = project_constrained(manifold, features, start, contacts, steps=60)
    assert constraints.bone_lengths_off(kept, manifold.lengths)[0] < 1e-20
    moved = constraints.feet_moved(plain, contacts)[0]
    assert constraints.feet_moved(kept, contacts)[0] < moved / 5**2  # a fifth of the way
    assert position_error(kept, features) < 1.1 * position_error(plain, features)


def test_a_pinned_hand_gets_there(trained):
    manifold, features, start = trained
    hand = JOINTS.index("left_wrist")
    plain = features_to_positions(manifold.project(features), start)
    targets, weights = np.full(plain.shape, np.nan), np.zeros(plain.shape[:2])
    targets[30, hand], weights[30, hand] = plain[30, hand] + [0.0, 0.1, 0.05], 1.0
    kept = project_constrained(manifold, features, start, pins=Pins(targets, weights), steps=60)
    reached = features_to_positions(kept, start)[30, hand]
    assert np.linalg.norm(reached - targets[30, hand]) < 0.03


def test_what_is_observed_stays_and_what_is_missing_fits(trained):
    manifold, features, _ = trained
    known = np.ones(features.shape, bool)
    gap = slice(20, 50), joint_slice("left_ankle")
    known[gap] = False
    damaged = features.copy()
    damaged[gap] = np.nan
    filled = project_observed(manifold, damaged, known)
    np.testing.assert_array_equal(filled[known], features[known])

    def error(x):
        return np.sqrt(np.mean((x[gap] - features[gap]) ** 2))

    assert error(filled) < error(interpolate_linearly(damaged, known)) / 2
    with pytest.raises(ValueError, match="nothing is known"):
        project_observed(manifold, features, np.zeros(features.shape, bool))


def test_poses_tell_of_a_joint_that_is_never_seen(trained):
    manifold, features, _ = trained
    known = np.ones(features.shape, bool)
    known[:, joint_slice("left_wrist")] = False
    takes = [
        manifold.features(body_of(make_take("walk", seed=seed, seconds=4, rate=30).motion))[0]
        for seed in range(6, 10)
    ]
    poses = poses_of(manifold, takes)
    without, told = (
        position_error(project_observed(manifold, features, known, steps=20, poses=each), features,
                       joint="left_wrist")
        for each in (None, poses)
    )  # fmt: skip
    assert told < without
    line, by_more = started(manifold, features, known)
    assert not by_more
    np.testing.assert_array_equal(line[known], features[known])
    start, by_more = started(manifold, features, known, poses)
    assert by_more
    np.testing.assert_allclose(start[known], features[known], atol=1e-6)


def test_energy_has_its_gradient():
    rng = np.random.default_rng(0)

    def total(path):
        value, d = energy(path)
        return np.float64(value), lambda upstream: upstream * d

    check_gradients(total, rng.normal(size=(4, 3, 2)), rng=rng)


def test_a_geodesic_is_no_longer_than_the_straight_path(trained):
    manifold, features, _ = trained
    one, other = manifold.encode(features[:40]), manifold.encode(features[25:65])
    found = geodesic(manifold, one, other, points=5, steps=30)
    np.testing.assert_array_equal(found.units[[0, -1]], [one, other])
    assert found.length < found.straight
    chord = geodesic(manifold, one, other, points=2)
    assert chord.length == chord.straight < found.length
    both = geodesic_lengths(manifold, np.stack([one, one]), np.stack([other, one]), 5, 30)
    assert both[0] == pytest.approx(found.length, rel=0.01)
    assert both[1] == pytest.approx(0, abs=1e-4)


def test_the_middle_of_a_geodesic_is_the_middle_of_its_path(trained):
    manifold, features, _ = trained
    one, other = features[:40], features[25:65]
    way = way_between(manifold, one, other, "geodesic")
    path = geodesic(manifold, manifold.encode(one), manifold.encode(other)).units
    for share, point in ((0, 0), (0.5, 4), (0.75, 6), (1, 8)):
        np.testing.assert_allclose(way(share), manifold.decode(path[point], 40), atol=1e-6)
    np.testing.assert_allclose(way("transition")[0], way(0)[0], atol=0.02)
    line = interpolate(manifold, one, other, "transition")
    np.testing.assert_allclose(line, way_between(manifold, one, other)("transition"))
    with pytest.raises(ValueError, match="'geodesic'"):
        interpolate(manifold, one, other, 0.5, "sphere")


def test_geodesic_distances_are_symmetric_and_those_of_nearest_windows(trained):
    manifold, features, _ = trained
    clips = [features[:64], features[3:67], features]
    apart = geodesic_matrix(manifold, clips)
    np.testing.assert_array_equal(apart, apart.T)
    np.testing.assert_allclose(apart, geodesic_matrix(manifold, clips, clips), atol=2e-3)
    assert apart[0, 2] == pytest.approx(0, abs=1e-3)  # the first window of the whole
    assert apart[0, 1] > 0.01
