"""The table of statements, and the studies whose right answer is known."""

import pytest

from studies import claims
from studies.comparison import EQUATION_4, RAW_EXTREMES
from studies.shared.material import Material
from studies.shared.result import STATEMENTS, Result


@pytest.fixture(scope="module")
def judged(small, small_manifold, labelled, tmp_path_factory):
    """The result for two networks, of few studies."""
    path = tmp_path_factory.mktemp("model") / "model.npz"
    small_manifold.save(path)
    small.setattr(claims, "STUDIES", ("kinect", "sampling"))
    small.setattr(claims, "judge_sequences", lambda quick, seed: Result("", []))
    return claims.run(labelled, 0, path, path, quick=True)


def test_statements_are_in_the_order_of_the_papers(judged):
    keys = [claim.key for claim in judged.claims]
    assert keys == sorted(keys, key=list(STATEMENTS).index)


@pytest.mark.parametrize(
    ("key", "times"), [("kinect_closer", 2), ("uniform_prior", 2), ("deep_justified", 1)]
)
def test_each_network_is_judged_by_each_study(judged, key, times):
    assert [claim.key for claim in judged.claims].count(key) == times


def test_each_claim_has_a_row(judged):
    assert len(judged.tables[0].rows) == len(judged.claims)


def test_a_study_that_cannot_be_run_is_in_the_note(small_manifold, labelled, monkeypatch):
    monkeypatch.setattr(claims, "STUDIES", ("interpolation",))
    notes = []
    without_testing = Material(labelled.training, [])
    monkeypatch.setattr(claims, "load_manifold", lambda path: small_manifold)
    judged = claims.judge_network("best", "model.npz", without_testing, 0, None, notes)
    assert judged == [] and "interpolation, best: could not be run" in notes[0]


def test_a_delay_changes_only_the_velocity_of_the_hips(result_of):
    _, shares, _, _ = result_of("comparison").tables
    assert shares.value(RAW_EXTREMES, "24 frames") < 0.02


def test_a_delay_changes_G_little(result_of):
    _, shares, _, _ = result_of("comparison").tables
    assert shares.value(EQUATION_4, "24 frames") < 0.2


def test_the_truth_has_no_error(result_of):
    _, table, _ = result_of("representation").tables
    assert table.value("truth", "error, cm") == 0


def test_random_unpooling_trembles(result_of):
    _, table, _ = result_of("representation").tables
    assert table.value("random unpooling", "of the truth's") > 1.5
