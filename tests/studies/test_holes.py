"""The study of holes: every length that fits, with errors of `fill` and of the best curve."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.motion.joints import joint_mask
from studies import holes


@pytest.fixture(scope="module")
def table(small_manifold, labelled):
    result = holes.run(small_manifold, labelled, takes=1, parts=("leg", "wrist"))
    (table,) = result.tables
    return table


def test_there_is_a_row_for_each_part_and_length_that_fits(table):
    names = [row[0] for row in table.rows]
    lengths = ("10 frames", "20 frames", "45 frames")
    assert names == [f"{part}, {length}" for part in ("wrist", "leg") for length in lengths]


def test_of_one_hole_the_ratio_is_that_of_both_errors(table):
    for _, count, filled, by_curve, ratio, _ in table.rows:
        assert count == 1
        least = holes.LEAST_ERROR
        assert ratio == pytest.approx(max(filled, least) / max(by_curve, least))


def test_the_best_curve_has_the_smallest_geometric_mean():
    names = list(holes.CURVES)
    errors = {holes.FILL: [1.0, 2.0], names[0]: [4.0, 4.0], names[1]: [1.0, 9.0]}
    errors[names[2]] = [5.0, 5.0]
    (row,) = holes.rows_of({"arm, 10 frames": errors})
    assert row[-1] == names[1].split()[0]
    np.testing.assert_allclose(row[2:5], [1.5, 5.0, np.sqrt(2) / 3])


def test_claims_compare_ratios_with_the_share_of_the_part():
    rows = [
        ["arm, 10 frames", 5, 1.0, 2.0, 0.5, "pchip"],
        ["arm, 20 frames", 5, 1.0, 1.0, 1.0, "x"],
    ]
    rows.append(["leg, 10 frames", 5, 1.0, 2.0, 0.5, "pchip"])
    claims = list(holes.claims_of(holes.Table("", holes.HEADER, rows), "bandai"))
    assert [(claim.of, claim.fulfilled) for claim in claims] == [
        ("bandai, arm", False),
        ("bandai, leg", True),
    ]


def test_the_error_is_that_of_the_missing_joints():
    motion = make_take("walk", 5, seconds=1.0, rate=30.0).motion
    mask = joint_mask(len(motion), ("left_wrist",), slice(10, 20))
    moved = motion.translations.copy()
    moved[10:15, 0] += (0.0, 0.02, 0.0)
    shifted = replace(motion, translations=moved)
    assert holes.error_of(shifted, motion, mask) == pytest.approx(1.0)


def test_an_unknown_part_is_refused(small_manifold, labelled):
    with pytest.raises(ValueError, match="no part tail: --parts has some of wrist, arm"):
        holes.run(small_manifold, labelled, parts=("tail",))
