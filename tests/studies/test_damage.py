"""Damage in a file's rig: it is where its mask says; simple methods change nothing else."""

from functools import partial

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.mocap import body_of, body_positions
from numpy_cae.motion import JOINTS
from studies import damage
from studies.shared.damages import DAMAGES
from studies.shared.material import LabelledTake
from studies.shared.result import png


@pytest.fixture(scope="module")
def take():
    return make_take("walk", 5, seconds=3.0, rate=60.0).motion


@pytest.mark.parametrize("kind", DAMAGES)
def test_damage_is_where_its_mask_says(take, kind):
    damaged, mask = DAMAGES[kind](take, np.random.default_rng(2))
    assert mask.shape == (len(take), 20) and mask.any()
    off = np.linalg.norm(body_positions(damaged) - body_positions(take), axis=-1)
    assert off[mask].mean() > 0.01
    np.testing.assert_allclose(off[~mask], 0, atol=1e-6)


def test_a_wrist_that_is_frozen_in_the_world_rests_where_the_arm_reaches(take):
    damaged, mask = DAMAGES["frozen in the world"](take, np.random.default_rng(2))
    frames, wrist = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))[-1]
    positions = body_positions(damaged)[:, wrist - 2 : wrist + 1]
    arm = np.linalg.norm(np.diff(positions[0], axis=0), axis=-1).sum()
    reached = np.linalg.norm(positions[:, 2] - positions[:, 0], axis=-1) < 0.98 * arm
    within = [frame for frame in frames[5:-5] if reached[frame]]
    assert JOINTS[wrist].endswith("wrist") and within
    assert np.abs(positions[within, 2] - positions[frames[0], 2]).max() < 0.01


def test_fillings_and_filters_keep_what_they_should(take, small_manifold):
    material = [LabelledTake(None, body_of(take))]
    _, mask = DAMAGES["twisted leg"](take, np.random.default_rng(3))
    fillings = [partial(damage.curve_filling, curve) for curve in damage.CURVES.values()]
    for filling in (*fillings, damage.gaussian_filling(small_manifold, material)):
        made = filling(take, mask)
        off = np.linalg.norm(body_positions(made) - body_positions(take), axis=-1)
        np.testing.assert_allclose(off[~mask], 0, atol=1e-6)
        assert 0 < off[mask].mean() < 0.3
    still = take.at(np.zeros(60, int))
    for name in damage.FILTERS:
        made = damage.filter_curves(still, name)
        np.testing.assert_allclose(made.positions(), still.positions(), atol=1e-6)


def test_findings_are_shares_of_joints_and_frames(result_of):
    found = result_of("damage").tables[3]
    shares = [value for row in found.rows for value in row[1:] if value is not None]
    assert found.value(damage.RECALL, "twisted leg") > 0 and 0 <= min(shares) <= max(shares) <= 100


def test_tables_of_damage_are_well_formed_and_drawn(result_of):
    result = result_of("damage")
    assert len(result.tables) == len(damage.TABLES)
    for table in result.tables:
        assert table.rows
        assert {len(row) for row in table.rows} == {len(table.header)}
    (picture,) = result.figures.values()
    assert len(png(picture)) > 5000
