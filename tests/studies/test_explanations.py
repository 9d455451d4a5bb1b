"""The study of explanations: its planted damage is where it says, its finder finds it."""

import numpy as np
import pytest

from data_synth import make_take, plan_takes, write_series
from numpy_cae.cleanup import Finding
from numpy_cae.mocap import body_positions
from studies import explanations
from studies.explaining.likelihood import explain
from studies.explaining.planted import ONSETS, PLANTS, Planted, moved_joints, turn_joint
from studies.explaining.scoring import Case, Outcome, Score


@pytest.fixture(scope="module")
def walk():
    return make_take("walk", 3, seconds=5.0, rate=30.0).motion


@pytest.mark.parametrize("kind", [kind for kind in PLANTS if kind != "cut"])
def test_an_event_changes_its_joints_in_its_frames_alone(walk, kind):
    rng = np.random.default_rng(1)
    damaged, event = PLANTS[kind](walk, slice(0, len(walk)), rng, 2, "")
    off = np.linalg.norm(body_positions(damaged) - body_positions(walk), axis=-1)
    assert off[event.stretch][:, moved_joints(event.joint)].max() > 0.02
    off[event.stretch, moved_joints(event.joint)] = 0.0
    assert off.max() < 1e-9


def test_a_cut_keeps_what_is_before_it(walk):
    joined, event = PLANTS["cut"](walk, slice(0, len(walk)), np.random.default_rng(1), 0, "")
    before = slice(0, event.first)
    np.testing.assert_array_equal(joined.rotations[before], walk.rotations[before])
    step = np.linalg.norm(np.diff(body_positions(joined), axis=0), axis=-1).mean(axis=1)
    assert np.argmax(step) == event.first - 1


@pytest.mark.parametrize("onset", [0, 2])
def test_the_ends_of_a_turned_leg_are_found(walk, onset):
    event = Planted("turned", "right_hip", 60, 90, onset)
    damaged = turn_joint(walk, event, np.array([0.9, 0.0, 0.0]), False)
    events, cuts = explain(damaged)
    name, best = max(events, key=lambda pair: pair[1].gain)
    assert (name, best.kind, best.first, best.end) == ("right_hip", "turned", 60, 91)
    assert (best.rise, best.fall) == (onset + 1, onset + 1) and cuts == []


def test_a_cut_explains_more_than_spikes(walk):
    joined, event = PLANTS["cut"](walk, slice(0, len(walk)), np.random.default_rng(1), 0, "")
    _, cuts = explain(joined)
    assert max(cuts, key=lambda cut: cut[1])[0] == event.first


def test_scores_count_right_and_wrong_findings(walk):
    event = Planted("turned", "left_hip", 30, 49)
    damaged = turn_joint(walk, event, np.array([0.9, 0.0, 0.0]), False)
    findings = [
        Finding("left_hip", (31, 49), "turned", confidence=0.8),
        Finding("right_elbow", (31, 49), "frozen", confidence=0.6),
        Finding("left_knee", (100, 101), "spike", confidence=0.95),
    ]
    score = Score()
    case = Case("synthetic", 30.0, 0, walk, damaged, [event])
    score.add(case, Outcome(findings, [], walk, 0.5))
    assert score.recall(0.7) == 1.0 and score.recall(0.9) == 0.0
    assert score.precision(0.5) == pytest.approx(1 / 3) and score.precision(0.9) == 0.0
    (scored,) = score.events
    assert scored.after == 0.0 and scored.before > 20


def test_an_onset_that_is_worse_than_its_neighbours_is_counted():
    assert explanations.is_isolated(np.array([1.0, 2.0, 55.0, 5.0, 6.0]))
    assert not explanations.is_isolated(np.array([1.0, 2.0, 3.0, 30.0, 50.0]))


def test_the_study_has_a_table_of_each_kind(small_manifold, tmp_path, monkeypatch):
    monkeypatch.setattr(explanations, "RATES", (24.0, 60.0))
    folder = tmp_path / "walks"
    write_series(plan_takes(0.1, 1, ["walk"]), folder, rate=30.0)
    result = explanations.run(small_manifold, [folder], takes=1)
    assert [len(table.header) for table in result.tables] == [7, 6, 4, 12, 10]
    for table in result.tables:
        assert table.rows
        assert {len(row) for row in table.rows} == {len(table.header)}
    legs = {row[0] for row in result.tables[-1].rows}
    assert {f"synthetic, {rate:g} Hz" for rate in explanations.RATES} <= legs
    assert len(ONSETS) == 5


def test_an_unknown_finder_is_refused(small_manifold, tmp_path):
    with pytest.raises(ValueError, match="no finder nose: --finder is one of repair, likelihood"):
        explanations.run(small_manifold, [tmp_path], finder="nose")
