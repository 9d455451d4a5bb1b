"""The studies of holden2015: tables have the right values, and claims follow from them."""

import numpy as np
import pytest

from numpy_cae.evaluation.tables import DAMAGED, GAUSSIAN, LINEAR, clips_of
from numpy_cae.motion import POSITIONS, features_to_positions
from numpy_cae.motion.hole_curves import ROTATION_CURVES
from studies import filling_in, interpolation, stepped_keys, wrist
from studies.interpolation import ALONG, ENDS
from studies.interpolation import LINEAR as STRAIGHT
from studies.repair_sweep import PS
from studies.shared.completions import NETWORK, PCHIP, WEIGHED, WITHOUT_NETWORK
from studies.shared.material import Material
from studies.shared.validity import Validity, bone_length_error

BONES, NEAREST = Validity.HEADER[0], Validity.HEADER[-1]


def test_the_sweep_of_removed_values(result_of):
    (table,) = result_of("repair_sweep").tables
    assert table.rows[0][0] == DAMAGED
    errors = np.array(table.rows[0][1:])  # they grow with the root of p
    np.testing.assert_allclose(errors / np.sqrt(PS), errors[2] / 0.5**0.5, rtol=0.1)
    at = {name: table.value(name, "p = 0.5") for name in (GAUSSIAN, LINEAR, DAMAGED)}
    assert at[GAUSSIAN] < at[LINEAR] < at[DAMAGED]


def test_values_are_completed_by_every_method(result_of):
    (table,) = result_of("filling_in").tables
    methods = [row[0] for row in table.rows]
    assert {PCHIP, NETWORK, WITHOUT_NETWORK, WEIGHED} < set(methods)
    assert all("(1.00)" in cell for cell in table.rows[methods.index(PCHIP)][1:])


def test_filling_in_needs_a_take(small_manifold, labelled):
    with pytest.raises(ValueError, match="1 or more"):
        filling_in.run(small_manifold, labelled, takes=0)


def test_interpolation_of_press_ups_and_walks(result_of, small_manifold, labelled):
    result = result_of("interpolation")
    press_ups, styles = result.tables
    assert "2 pairs" in press_ups.caption and "1 pairs" in styles.caption
    for table in result.tables:
        assert table.value(ENDS, BONES) < 0.5 < table.value(STRAIGHT, BONES)
    one, other = interpolation.clips_of_pair(small_manifold, *labelled.testing[:2])
    assert len(one) == len(other) == 32
    np.testing.assert_allclose(interpolation.linear(one, other, 0.5), (one + other) / 2)
    with pytest.raises(ValueError, match="neither press-ups"):
        interpolation.run(small_manifold, Material(labelled.training, []))


MEASURED = {
    ENDS: [Validity(0, 0, 4, 0)] * 3,
    ALONG: [Validity(1, 1, 3, 1)] * 3,
    STRAIGHT: [Validity(2, 2, 9, 2)] * 3,
    interpolation.WITH_LENGTHS: [Validity(0, 2, 9, 2)] * 3,
}


def test_a_claim_is_fulfilled_if_all_measures_are_better():
    claim = interpolation._claim("walks", MEASURED)
    assert claim.fulfilled and "on 4 of 4 measures" in claim.figures


def test_a_jitter_nearer_to_that_of_the_two_motions_is_better():
    nearer = MEASURED | {STRAIGHT: [Validity(2, 2, 4.5, 2)] * 3}
    assert interpolation._claim("walks", nearer).fulfilled is False


def test_equal_measures_are_not_better():
    equal = MEASURED | {ALONG: MEASURED[STRAIGHT]}
    assert "on 0 of 4" in interpolation._claim("walks", equal).figures


def test_a_measure_that_pairs_do_not_decide_is_undecided():
    mixed = [Validity(1, 1, 3, 1), Validity(1, 1, 3, 3), Validity(1, 1, 3, 1)]
    assert interpolation._claim("walks", MEASURED | {ALONG: mixed}).fulfilled is None


def test_bones_are_set_to_their_lengths(small_manifold, labelled):
    clip, other = interpolation.clips_of_pair(small_manifold, *labelled.testing[:2])
    changed = interpolation.set_bone_lengths((clip + other) / 2, small_manifold.lengths)
    positions = features_to_positions(changed)
    assert bone_length_error(positions, small_manifold.lengths) < 1e-6


def test_sampling_measures_priors_beside_real_motion(result_of):
    (table,) = result_of("sampling").tables
    assert table.value("test takes", BONES) < table.value("uniform prior", BONES)
    assert table.value("uniform prior", NEAREST) > table.value("fitted prior", NEAREST)
    uniform, fitted, values = result_of("sampling").claims
    assert not uniform.fulfilled and "fitted to encoded motion" in fitted.sentence
    assert values.key == "easily_invalid" and values.fulfilled


def test_a_missing_marker_is_read_at_its_joint(result_of, small_manifold, labelled):
    (table,) = result_of("wrist").tables
    clips = clips_of(small_manifold, [take.positions for take in labelled.testing])
    lost = clips.x.copy()
    lost[..., 21:24] = 0
    for window, is_real in zip(lost, clips.real, strict=True):  # no frames that pad a take
        window[is_real] = small_manifold.network.project(window[is_real][None])[0]
    expected = clips.error(lost, "left_wrist")
    assert table.value(wrist.NETWORK, "left_wrist") == pytest.approx(expected, rel=1e-4)


def test_regression_on_the_other_joints_is_better_than_the_mean_pose(result_of):
    (table,) = result_of("wrist").tables
    assert table.value(wrist.RIDGE, "both") < table.value(wrist.MEAN_POSE, "both")


def test_the_wrist_of_the_mean_pose_is_where_it_is_removed(result_of, small_manifold, labelled):
    (table,) = result_of("wrist").tables
    clips = clips_of(small_manifold, [take.positions for take in labelled.testing])
    missing = clips.x.copy()
    missing[..., 21:24] = 0
    assert table.value(wrist.MEAN_POSE, "left_wrist") == pytest.approx(
        clips.error(missing, "left_wrist")
    )


def test_a_claim_that_an_average_fulfils_is_not_distinctive():
    ones = np.ones(5)
    truth = stepped_keys.Measured(0 * ones, 0 * ones, 4 * ones, ones)
    held = stepped_keys.Measured(6 * ones, 6 * ones, 9 * ones, ones)
    better = stepped_keys.Measured(5 * ones, 5 * ones, 4 * ones, ones)
    measured = dict.fromkeys((*stepped_keys.FREE, stepped_keys.NETWORK), better)
    measured |= {stepped_keys.TRUE: truth, stepped_keys.HELD: held, stepped_keys.LINEAR: held}
    verdicts = [claim.verdict for claim in stepped_keys._claims(measured)]
    assert verdicts == ["not distinctive"] * 3


def test_rotation_curves_are_nearer_than_the_held_keys(result_of):
    (table,) = result_of("stepped_keys").tables
    held = table.value(stepped_keys.HELD, "error, cm")
    for curve in ROTATION_CURVES:
        assert 0 < table.value(stepped_keys.CURVE.format(curve), "error, cm") < held
    assert table.value(stepped_keys.TRUE, "error, cm") == 0


def test_rotation_curves_have_the_keys(small_manifold, labelled):
    take = labelled.testing[0]
    filled = stepped_keys.fill_steps(small_manifold, small_manifold.features(take.positions)[0])
    truth = filled[stepped_keys.TRUE]
    motion = labelled.motion(take).resampled(small_manifold.rate).at(slice(len(truth)))
    for x in stepped_keys.fill_by_curves(small_manifold, motion).values():
        np.testing.assert_allclose(x[::15, POSITIONS], truth[::15, POSITIONS], atol=0.005)


def test_transitions_end_at_the_last_key(small_manifold):
    features = np.cumsum(np.random.default_rng(0).normal(size=(40, 63)), axis=0) / 100
    filled = stepped_keys.fill_steps(small_manifold, features)
    assert {len(x) for x in filled.values()} == {31}
    np.testing.assert_array_equal(filled[stepped_keys.HELD][16], features[15])


def test_the_values_that_are_left_say_much_of_the_removed_ones(result_of):
    claims = {claim.key: claim for claim in result_of("repair_sweep").claims}
    assert claims["half_of_information"].fulfilled is not True
