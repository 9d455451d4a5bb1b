"""The table of statements, and the studies whose right answer is known."""

from importlib import import_module

import numpy as np
import pytest

from numpy_cae.training import Schedule, Stage
from studies import claims
from studies.comparison import EQUATION_4, RAW_EXTREMES, untrained
from studies.shared.material import Material
from studies.shared.result import STATEMENTS, Claim, text
from studies.shared.trained import Trainer


@pytest.fixture(scope="module")
def judged(small, small_manifold, labelled, tmp_path_factory):
    """The result for a network of a file, of few studies."""
    path = tmp_path_factory.mktemp("model") / "small.npz"
    small_manifold.save(path)
    small.setattr(claims, "STUDIES", {"kinect": {}, "sampling": {}})
    small.setattr(claims, "SMALL_STUDIES", ())
    small.setattr(claims, "judge_sequences", lambda *arguments: [])
    return claims.run(labelled, network=path)


def test_statements_are_in_the_order_of_the_papers(judged):
    keys = [claim.key for claim in judged.claims]
    assert keys == sorted(keys, key=list(STATEMENTS).index)


@pytest.mark.parametrize("key", ["kinect_closer", "uniform_prior"])
def test_the_network_of_a_file_is_judged_alone_by_each_study(judged, key):
    assert [claim.of for claim in judged.claims if claim.key == key] == ["small"]


def test_each_claim_has_a_row_and_is_counted(judged):
    counts, table = judged.tables
    assert len(table.rows) == len(judged.claims) == sum(row[1] for row in counts.rows)


def test_a_claim_says_what_it_is_measured_on(judged):
    printed = text(judged)
    assert "Opponents: a linear map of 15 frames fitted to the same noise" in printed
    assert "Spread: 95% of 1,000 bootstrap samples of the takes." in printed


def test_a_study_that_cannot_be_run_is_in_the_note(small_manifold, labelled, monkeypatch):
    monkeypatch.setattr(claims, "STUDIES", {"interpolation": {}})
    notes = []
    without_testing = Material(labelled.training, [])
    named = {"best": [small_manifold, small_manifold]}
    judged = claims.judge_networks("interpolation", named, without_testing, notes)
    assert judged == [] and len(notes) == 1
    assert "interpolation, best: could not be run" in notes[0]


@pytest.mark.parametrize(
    ("study", "own"), [("kinds_of_motion", {}), ("repair_sweep", {"shares": (0.5,)})]
)
def test_what_needs_no_network_is_measured_once(
    study, own, small, small_manifold, labelled, monkeypatch
):
    module = import_module(f"studies.{study}")
    measured = []
    measure = module.measure_motion

    def measure_and_count(*arguments, **named_arguments):
        measured.append(study)
        return measure(*arguments, **named_arguments)

    initial = untrained(small_manifold, 0)
    networks = (small_manifold, initial)
    expected = [module.run(network, labelled, **own).claims for network in networks]
    monkeypatch.setattr(claims, "STUDIES", {study: own})
    monkeypatch.setattr(module, "measure_motion", measure_and_count)
    named = {"best": [small_manifold], "untrained": [initial]}
    of_both = claims.judge_networks(study, named, labelled, [])
    assert measured == [study]
    assert [claim.of_seeds[0] for claim in of_both] == [*expected[0], *expected[1]]


def test_a_claim_without_a_network_is_listed_once():
    judged = []
    for network in ("the paper's", "best"):
        for key, of in (("small_subspace", "frames"), ("small_subspace", ""), ("even_smooth", "")):
            judged.append(claims.JudgedClaim(network, [Claim(key, True, "1 cm.", of)]))
    listed = [claim.named().statement.rpartition(")")[2] for claim in claims.keep_once(judged)]
    assert listed == [": frames", "", ": the paper's", ": best"]


@pytest.mark.parametrize(
    ("of_seeds", "verdict"),
    [
        ([True, True], "confirmed"),
        ([True, False], "no difference"),
        ([False, False], "refuted"),
        ([True, None], "no difference"),
    ],
)
def test_seeds_that_differ_decide_nothing(of_seeds, verdict):
    judged = claims.JudgedClaim(
        "best", [Claim("half_recovered", value, "1.") for value in of_seeds]
    )
    assert judged.row()[-2] == verdict


def test_an_opponent_has_to_fulfil_the_rule_with_every_seed():
    fulfilled = [Claim("half_recovered", True, "1.", fulfilled_by=name) for name in ("PCA", "")]
    assert claims.JudgedClaim("best", fulfilled).merged().verdict == "confirmed"
    assert claims.JudgedClaim("best", fulfilled[:1]).merged().verdict == "not distinctive"


def test_networks_of_each_recipe_and_seed_are_kept(labelled, tmp_path, monkeypatch):
    short = Schedule(Stage(epochs=0), Stage(epochs=1, batch=16, optimiser="adam", rate=0.001))
    monkeypatch.setattr(claims, "recipe", lambda name: short)
    arguments = (labelled, 0, Trainer(tmp_path), None, False, 2)
    networks = dict(claims.networks_to_judge(*arguments))
    assert list(networks) == [claims.PAPER, claims.BEST]
    assert len(list(tmp_path.iterdir())) == 2  # both recipes are the same here
    again = dict(claims.networks_to_judge(*arguments))
    first = networks[claims.BEST][0].network.parameters["w1"]
    np.testing.assert_array_equal(again[claims.BEST][0].network.parameters["w1"], first)
    assert np.any(networks[claims.BEST][1].network.parameters["w1"] != first)


def test_each_kind_of_the_press_ups_is_tested(tmp_path):
    material = claims.make_material(tmp_path, 1.5, 0, ("press_ups", "walk"))
    assert {take.content for take in material.testing} == {"press_ups", "walk"}


def test_a_delay_changes_only_the_velocity_of_the_hips(result_of):
    _, shares, _, _ = result_of("comparison").tables
    assert shares.value(RAW_EXTREMES, "24 frames") < 0.02


def test_a_delay_changes_G_little(result_of):
    _, shares, _, _ = result_of("comparison").tables
    assert shares.value(EQUATION_4, "24 frames") < 0.2


def test_the_truth_has_no_error(result_of):
    _, table, *_ = result_of("representation").tables
    assert table.value("truth", "error, cm") == 0


def test_random_unpooling_trembles(result_of):
    _, table, *_ = result_of("representation").tables
    assert table.value("random unpooling", "of the truth's") > 1.5
