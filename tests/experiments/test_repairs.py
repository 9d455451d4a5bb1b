"""Repair and filling in: the values of the tables are right, and claims follow from them."""

from pathlib import Path

import numpy as np
import pytest

from numpy_cae.experiments.clips import (
    AVERAGED,
    NETWORK,
    REPEATED,
    clips_of,
    project_repeated,
)
from numpy_cae.experiments.material import LabelledTake, unlabelled
from numpy_cae.experiments.repair import half_removed, repair_sweep
from numpy_cae.experiments.repair.repair_sweep import CORRUPTED_ROW, LINEAR, RESCALED

HALF = "p = 0.5"


def test_the_sweep_of_removed_values(result_of):
    blind, known = result_of("repair_sweep").tables
    assert blind.rows[0][0] == CORRUPTED_ROW
    errors = np.array(blind.rows[0][1:])  # they grow with the root of p
    np.testing.assert_allclose(errors / np.sqrt([0.1, 0.5, 0.9]), errors[1] / 0.5**0.5, rtol=0.1)
    assert known.rows[0][1] < min(row[1] for row in blind.rows)
    for row in blind.rows:
        if row[0].startswith("Savitzky"):
            assert blind.value(LINEAR, HALF) < row[2]


def test_claims_of_the_sweep_follow_its_errors():
    networks = [name + suffix for name in (NETWORK, REPEATED, AVERAGED)
                for suffix in ("", RESCALED)]  # fmt: skip
    errors = {name: [5.0] * 9 for name in networks}
    errors |= {CORRUPTED_ROW: [9.0] * 9, "PCA on frames": [3.0] * 9, LINEAR: [2.0] * 9}
    errors[NETWORK] = [1.0] * 3 + [4.0] * 6

    def confirmed(suffix=""):
        return [claim.confirmed for claim in repair_sweep._claims(errors, 1.5, suffix)]

    assert confirmed() == [True, False, False]
    errors[NETWORK][4] = 1.9
    assert confirmed() == [True, True, True]
    errors[NETWORK][4] = 4.6
    assert not confirmed()[0]
    errors[NETWORK + RESCALED][4] = 4.4
    assert not confirmed()[0] and confirmed(RESCALED)[0]


def test_a_missing_marker_is_read_at_its_joint(result_of, small_manifold, labelled):
    wrists, stepped = result_of("filling_in").tables
    clips = clips_of(small_manifold, [take.positions for take in labelled.testing])
    lost = clips.x.copy()
    lost[..., 21:24] = 0
    assert wrists.value("left_wrist", "the mean pose") == clips.error(lost, "left_wrist")
    expected = clips.error(project_repeated(small_manifold, lost), "left_wrist")
    assert wrists.value("left_wrist", NETWORK) == pytest.approx(expected)
    assert stepped.value("truth", "error, cm") == 0 < stepped.value("held", "error, cm")


def test_rows_that_need_no_network(small_manifold, labelled):
    half = half_removed.run(small_manifold, labelled).tables[0]
    whole, lost = half.header[1:3]
    assert half.value("as damaged", whole) == 0
    assert half.value("PCA on frames", whole) == pytest.approx(0, abs=1e-4)
    # Half of all values lost at random: half of the mean pose's squared error remains.
    mean = half.value("the mean pose", lost)
    assert half.value("the mean pose", whole) == mean
    assert half.value("as damaged", lost) == pytest.approx(mean * np.sqrt(0.5), rel=0.05)
    assert half.value("PCA on frames", lost) < mean and half.value("PCA on windows", lost) < mean


def test_figure_1_has_one_clip_three_times(small_manifold, labelled):
    take = labelled.testing[0].positions
    material = unlabelled([], [take])
    assert material.testing[0] == LabelledTake(Path("take 1"), take)
    result = half_removed.figure_1(small_manifold, material)
    (table,) = result.tables
    assert table.value("truth", "error, cm") == 0 < table.value("corrupted", "error, cm")
    assert len(result.animation.actors) == 3 and result.png()
