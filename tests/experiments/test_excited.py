"""The motions that excite a unit: those in which it is highest, at the moment when it is."""

import numpy as np
import pytest

from numpy_cae.experiments import excited as story
from numpy_cae.experiments.material import Material
from numpy_cae.manifold import hidden_units


@pytest.fixture(scope="module")
def found(small_manifold, labelled):
    return story.excited(small_manifold, Material([], labelled.training))


def test_a_unit_is_highest_where_it_says(found, small_manifold, labelled):
    take, unit = 3, 7
    features, _ = small_manifold.features(labelled.training[take].positions)
    units = hidden_units(small_manifold, features)
    assert found.highest[take, unit] == units[:, unit].max()
    assert units[found.moment[take, unit] // 4, unit] == units[:, unit].max()
    best = found._top(unit)[0]
    assert found.highest[best, unit] == found.highest[:, unit].max()


def test_the_top_takes_agree_in_what_they_bear():
    highest = np.array([[9.0, 1], [8, 2], [7, 3], [6, 4], [5, 5], [4, 6], [3, 7]])
    # Unit 1: takes 0 to 4; unit 2: takes 6 to 2.
    agreement = story._agreement(highest, ["a", "a", "b", "a", "a", "c", "c"])
    np.testing.assert_allclose(agreement, [4 / 5, 2 / 5])


def test_chosen_units_are_excited_by_different_takes(found):
    tops = [take for unit in found._chosen() for take in found._top(unit)[: story.ROWS]]
    assert tops and len(set(tops)) == len(tops)


def test_what_is_shown_is_of_the_take_and_of_one_length(found):
    for moment in (0, 40, 89):
        assert found._about(0, moment).shape == (story.SHOWN, 20, 3)
    np.testing.assert_array_equal(found._about(0, 89)[-1], found.local[0][-1])
    np.testing.assert_array_equal(found._about(0, 40)[story.SHOWN // 2], found.local[0][40])


def test_text_findings_and_picture(found, tmp_path):
    assert "drawn at random" in found.text()
    for label, finding in zip(("content", "style"), found.findings(), strict=True):
        assert f"{found.agreement[label]['trained'].mean():.2f}" in finding.measured
    found.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_too_few_takes(small_manifold, labelled):
    with pytest.raises(ValueError, match="needs 5 held-out takes, there are 4"):
        story.excited(small_manifold, labelled)
