"""The table of comparisons: what counts as alike, and what the numbers can be."""

import numpy as np
import pytest
from numpy_cae.experiments.geodesics import CURVED, FREE, LATENT, SHORTEST, geodesics

from numpy_cae.experiments.comparison.comparison import comparison
from numpy_cae.experiments.comparison.distances import EQUATION_4, EUCLIDEAN
from numpy_cae.experiments.material import Material


@pytest.fixture(scope="module")
def measured(small_manifold, labelled):
    return comparison(small_manifold, labelled, seed=1)


def test_a_label_is_asked_for_only_where_there_is_something_to_find(measured):
    # "neutral" is the one style that both contents have: the takes of the others are not asked.
    assert {label: len(each[EQUATION_4]) for label, each in measured.average.items()} == {
        "content": 4,
        "style": 4,
        "both": 4,
        "content, other style": 4,
        "style, other content": 2,
    }
    for scores in (measured.precision, measured.average):
        for each in scores.values():
            assert all(np.all((one >= 0) & (one <= 1)) for one in each.values())


def test_walking_and_waving_are_told_apart_and_chance_does_not(measured):
    for name in (EQUATION_4, EUCLIDEAN):
        assert measured.average["content"][name].mean() > 0.9
    assert measured.average["content"]["drawn at random"].mean() < 0.9


def test_the_text_has_a_row_for_every_distance_and_findings_follow_the_numbers(measured, tmp_path):
    text = measured.text()
    for name in measured.average["content"]:
        assert f"| {name} " in text
    for label, finding in zip(measured.average, measured.findings(), strict=False):
        gap = measured.difference(EUCLIDEAN, label)
        assert finding.held == (gap.low > 0)
        assert gap.text() in finding.measured
    measured.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_nothing_held_out_nothing_compared(small_manifold, labelled):
    with pytest.raises(ValueError, match="labelled takes"):
        comparison(small_manifold, Material(labelled.training, []))


def test_geodesics_beside_lines(small_manifold, labelled, tmp_path, monkeypatch):
    monkeypatch.setattr("numpy_cae.experiments.geodesics.FRAMES", 32)
    result = geodesics(small_manifold, labelled)
    assert np.all(result.lengths[SHORTEST] > 1 - 1e-6)
    assert np.median(result.lengths[SHORTEST]) < np.median(result.lengths[LATENT])
    errors = [result.halfway[k][FREE] for k in (4, 8, 16)]
    assert 0 < errors[0] < errors[1] < errors[2]
    for label, each in result.average.items():
        assert set(each) == set(result.precision[label])
        assert all(np.all((0 <= one) & (one <= 1)) for one in each.values())
    curved, halfway, *finds = result.findings()
    assert curved.held == bool(np.median(result.lengths[SHORTEST]) >= CURVED)
    nearest = [min(e, key=e.get) == SHORTEST for e in result.halfway.values()]
    assert halfway.held == all(nearest)
    assert len(finds) == 3 and "| geodesic" in result.text()
    result.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000
