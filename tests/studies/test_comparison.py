"""Distances between motions and what they find; errors against windows."""

import numpy as np
import pytest

from numpy_cae.evaluation.tables import clips_of
from numpy_cae.manifold import G, hidden_units
from studies import comparison
from studies.comparison import EQUATION_4, EUCLIDEAN, RANDOM, average_precision, distances
from studies.shared.material import Material


@pytest.fixture(scope="module")
def clips(small_manifold, labelled):
    return [small_manifold.features(take.positions)[0] for take in labelled.testing]


def test_every_distance_is_symmetric_and_zero_on_the_diagonal(small_manifold, clips):
    for name, rows in comparison.rows_of_distances(small_manifold).items():
        between = distances(rows, clips, clips)
        assert between.shape == (5, 5)
        np.testing.assert_allclose(between, between.T, atol=1e-6)
        np.testing.assert_allclose(np.diag(between), 0, atol=1e-5)
        assert np.all(between[~np.eye(5, dtype=bool)] > 0)
        np.testing.assert_allclose(distances(rows, clips, clips[:3]), between[:, :3], atol=1e-6)
        if name == EQUATION_4:
            units = [hidden_units(small_manifold, clip) for clip in clips]
            assert between[0, 1] ** 2 == pytest.approx(G(units[0], units[1]), rel=1e-5)


def test_only_takes_with_something_to_find_are_queries(small_manifold, labelled, clips):
    training = [small_manifold.features(take.positions)[0] for take in labelled.training]
    rows = comparison.rows_of_distances(small_manifold)
    between = {name: distances(rows[name], clips, training) for name in (EQUATION_4, EUCLIDEAN)}
    between[RANDOM] = np.random.default_rng(0).random((5, 10))
    precisions = comparison.precisions_of_queries(between, labelled.testing, labelled.training)
    average = comparison.mean_precisions(precisions)
    assert list(average) == [
        "content", "style", "both", "content, other style", "style, other content"
    ]  # fmt: skip
    for name in (EQUATION_4, EUCLIDEAN):
        assert average["content"][name] > 0.9
    assert average["content"][RANDOM] < 0.9
    # "neutral" is the one style that two contents share: without it there are no such queries.
    walks = [take for take in labelled.testing if take.content == "walk"]
    few = {name: d[:2, :4] for name, d in between.items()}
    assert "style, other content" not in comparison.precisions_of_queries(
        few, walks, labelled.training[:4]
    )


def test_a_claim_needs_the_higher_mean_of_the_queries():
    untrained = comparison.UNTRAINED
    names = (EQUATION_4, EUCLIDEAN, comparison.RAW_EXTREMES, untrained, comparison.PRINCIPAL)
    precisions = {name: np.full(9, 0.5) for name in names}
    precisions[EQUATION_4] = np.full(9, 0.75)
    precisions[untrained] = 0.75 + np.array([0.2] * 4 + [-0.2] * 5)
    claims = comparison._claims({"content": precisions})
    assert [claim.fulfilled for claim in claims] == [True, True, None, True]
    assert "+0.25 (+0.25 to +0.25)" in claims[0].figures
    assert "content +0.25" in claims[1].figures


def test_takes_without_labels_are_refused(small_manifold, labelled):
    with pytest.raises(ValueError, match="labelled takes"):
        comparison.run(small_manifold, Material(labelled.training, []))


def test_the_take_that_a_delay_changes_most_counts(small_manifold, labelled):
    clips = [small_manifold.features(take.positions)[0] for take in labelled.testing]
    few = {name: lambda clip: clip[:1] for name in (EQUATION_4, EUCLIDEAN)}
    few[comparison.RAW_EXTREMES] = lambda clip: np.array([[clip[:, 60].sum()]])
    result = comparison.delays(few, clips)
    median, worst = result.tables
    for name in few:
        assert median.value(name, "8 frames") <= worst.value(name, "8 frames")
    (claim,) = result.claims
    assert claim.fulfilled == (max(worst.rows[0][1:]) <= comparison.MOST)


def test_the_error_is_in_centimetres(small_manifold, labelled):
    clips = clips_of(small_manifold, [take.positions for take in labelled.testing])
    assert clips.error(clips.x) == 0
    off = clips.x.copy()
    off[..., 21:24] += 0.01 * small_manifold.scale[21:24].astype(np.float32)
    assert clips.error(off, "left_wrist") == pytest.approx(1.0, rel=1e-3)
    assert clips.error(off) == pytest.approx(np.sqrt(1 / 20), rel=1e-3)
    assert clips.real.all() and len(np.unique(clips.take)) == len(labelled.testing)


# Ranked, with * for relevant: 1*, 3, 0*, 2; and 2, 0, 3*, 1*.
DISTANCES = np.array([[3.0, 1.0, 4.0, 2.0], [2.0, 9.0, 1.0, 3.0]])
RELEVANT = np.array([[True, True, False, False], [False, True, False, True]])


def test_the_average_precision_by_hand():
    # Ranks 1 and 3: (1/1 + 2/3) / 2. Ranks 3 and 4: (1/3 + 2/4) / 2.
    np.testing.assert_allclose(average_precision(DISTANCES, RELEVANT), [5 / 6, 5 / 12])


def test_a_motion_at_an_infinite_distance_is_left_out():
    distances = DISTANCES.copy()
    distances[0, 1] = np.inf
    # Ranked: 3 (not), 0 (relevant), 2 (not); only one is left to be found, at rank 2.
    assert average_precision(distances, RELEVANT)[0] == pytest.approx(1 / 2)


def test_a_query_without_an_answer_is_refused():
    alone = np.array([[np.inf, 1.0]])
    with pytest.raises(ValueError, match="nothing in the gallery is like query 0"):
        average_precision(alone, np.array([[True, False]]))
