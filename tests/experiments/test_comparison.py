"""Distances between motions and what they find."""

import numpy as np
import pytest

from numpy_cae.experiments import interpolation
from numpy_cae.experiments.comparison import comparison, shift
from numpy_cae.experiments.comparison.distances import (
    EQUATION_4,
    EUCLIDEAN,
    all_distances,
    equation_4,
)
from numpy_cae.experiments.comparison.shift import SHIFTS
from numpy_cae.experiments.material import Material
from numpy_cae.manifold import G, hidden_units


@pytest.fixture(scope="module")
def clips(small_manifold, labelled):
    return [small_manifold.features(take.positions)[0] for take in labelled.testing]


def test_every_distance_is_symmetric_and_zero_on_the_diagonal(small_manifold, clips):
    distances = all_distances(small_manifold, clips)
    assert len({each.name for each in distances}) == len(distances)
    for each in distances:
        own = each.between(clips)
        assert own.shape == (5, 5)
        np.testing.assert_allclose(own, own.T, atol=1e-6)
        np.testing.assert_allclose(np.diag(own), 0, atol=1e-5)
        assert np.all(own[~np.eye(5, dtype=bool)] > 0)
        np.testing.assert_allclose(each.between(clips, clips[:3]), own[:, :3], atol=1e-6)


def test_equation_4_is_the_root_of_g(small_manifold, clips):
    units = [hidden_units(small_manifold, clip) for clip in clips]
    between = equation_4(small_manifold).between(clips)
    assert between[0, 1] ** 2 == pytest.approx(G(units[0], units[1]), rel=1e-5)


@pytest.fixture(scope="module")
def scores(small_manifold, labelled, clips):
    training = [small_manifold.features(take.positions)[0] for take in labelled.training]
    between = {d.name: d.between(clips, training) for d in all_distances(small_manifold, training)}
    between[comparison.RANDOM] = np.random.default_rng(0).random((5, 10))
    return comparison.retrieved(between, labelled.testing, labelled.training)


def test_only_takes_with_something_to_find_are_queries(scores):
    # "neutral" is the one style that two contents share.
    assert {label: len(each[EQUATION_4]) for label, each in scores[1].items()} == {
        "content": 5,
        "style": 5,
        "both": 5,
        "content, other style": 4,
        "style, other content": 2,
    }
    for name in (EQUATION_4, EUCLIDEAN):
        assert scores[1]["content"][name].mean() > 0.9
    assert scores[1]["content"][comparison.RANDOM].mean() < 0.9
    for each in [*scores[0].values(), *scores[1].values()]:
        assert all(np.all((one >= 0) & (one <= 1)) for one in each.values())


def test_claims_follow_the_differences(result_of):
    result = result_of("comparison")
    gaps = result.tables[1]
    for claim, label in zip(result.claims, gaps.header[1:], strict=False):
        gap = gaps.value(EUCLIDEAN, label)
        assert gap in claim.figures
        assert claim.held == (float(gap.split("(")[1].split()[0]) > 0)


def test_a_still_clip_does_not_change_when_shifted(small_manifold, clips):
    still = np.repeat(clips[0][:1], 90, axis=0)
    moved = shift.shifted(small_manifold, [*clips, still], 32)
    for each in moved.values():
        assert each.shape == (6, len(SHIFTS))
        np.testing.assert_allclose(each[-1], 0, atol=1e-5)
        assert np.all(each[:-1] > 0)


def test_a_shift_is_relative_to_the_distance_to_others(small_manifold, clips):
    x = [small_manifold.normalise(clip) for clip in clips]
    itself = np.linalg.norm(x[1][:32] - x[1][5:37])
    others = [np.linalg.norm(x[1][:32] - x[n][:32]) for n in (0, 2, 3, 4)]
    moved = shift.shifted(small_manifold, clips, 32)
    assert moved[EUCLIDEAN][1, SHIFTS.index(5)] == pytest.approx(itself / np.median(others))


@pytest.mark.parametrize(
    ("experiment", "message"),
    [
        (comparison, "labelled takes"),
        (shift, "two held-out takes of 72 frames, there are 0"),
        (interpolation, "neither press-ups"),
    ],
)
def test_without_suitable_takes_an_experiment_is_refused(
    small_manifold, labelled, experiment, message
):
    with pytest.raises(ValueError, match=message):
        experiment.run(small_manifold, Material(labelled.training, []))
