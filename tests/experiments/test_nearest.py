"""The ranked lists: of the right motions, in the right order."""

import numpy as np
import pytest

from numpy_cae.experiments import nearest as story
from numpy_cae.experiments.comparison.distances import euclidean


@pytest.fixture(scope="module")
def told(small_manifold, labelled):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(story, "QUERIES", 2)
        patch.setattr(story, "TAKES", 2)
        patch.setattr(story, "SECONDS", 1.2)
        yield story.nearest(small_manifold, labelled, seed=3)


def test_the_lists_are_of_rising_distance(told, small_manifold):
    assert len(told.gallery) == len(told.scenes) == 2 * len(story.SCENES)
    for name, order in told.ranked.items():
        far = np.take_along_axis(told.far[name], order, axis=1)
        assert np.all(np.diff(far, axis=1) >= 0)
    one, other = (small_manifold.features(take)[0] for take in (told.queries[1], told.gallery[4]))
    expected = euclidean(small_manifold).between([one], [other])[0, 0]
    assert told.far["Euclidean"][1, 4] == pytest.approx(expected)


def test_the_findings_follow_the_lists(told):
    by_g, by_euclid = told.findings()
    found = [scene for query in range(2) for scene in told.found("G", query)]
    assert by_g.held == all(scene in story.ALIKE for scene in found)
    odd = [bool(set(story.ODD) & set(told.found("Euclidean", query))) for query in range(2)]
    assert by_euclid.held == (sum(odd) > 1)
    assert told.found("G", 0)[0] in told.text()


def test_the_pictures_are_drawn(told, tmp_path):
    told.save_picture(tmp_path / "a.png")
    told.save_gif(tmp_path / "a.gif")
    assert (tmp_path / "a.png").stat().st_size > 10_000
    assert (tmp_path / "a.gif").read_bytes().startswith(b"GIF")
