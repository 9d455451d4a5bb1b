"""The studies of holden2015: tables have the right values, and claims follow from them."""

import numpy as np
import pytest

from numpy_cae.evaluation.tables import DAMAGED, GAUSSIAN, LINEAR, clips_of
from numpy_cae.motion.hole_curves import ROTATION_CURVES
from studies import interpolation
from studies.filling_in import NETWORK
from studies.interpolation import ALONG, ENDS
from studies.interpolation import LINEAR as STRAIGHT
from studies.repair_sweep import PS
from studies.shared.material import Material
from studies.shared.validity import Validity

BONES, NEAREST = Validity.HEADER[0], Validity.HEADER[-1]


def test_the_sweep_of_removed_values(result_of):
    (table,) = result_of("repair_sweep").tables
    assert table.rows[0][0] == DAMAGED
    errors = np.array(table.rows[0][1:])  # they grow with the root of p
    np.testing.assert_allclose(errors / np.sqrt(PS), errors[2] / 0.5**0.5, rtol=0.1)
    at = {name: table.value(name, "p = 0.5") for name in (GAUSSIAN, LINEAR, DAMAGED)}
    assert at[GAUSSIAN] < at[LINEAR] < at[DAMAGED]


def test_a_missing_marker_is_read_at_its_joint(result_of, small_manifold, labelled):
    wrists, stepped = result_of("filling_in").tables
    clips = clips_of(small_manifold, [take.positions for take in labelled.testing])
    lost = clips.x.copy()
    lost[..., 21:24] = 0
    assert wrists.value("left_wrist", "the mean pose") == clips.error(lost, "left_wrist")
    whole = [small_manifold.project(x) for x in small_manifold.denormalise(lost)]
    expected = clips.error(small_manifold.normalise(np.stack(whole)), "left_wrist")
    assert wrists.value("left_wrist", NETWORK) == pytest.approx(expected)
    held = stepped.value("held", "error, cm")
    for curve in ROTATION_CURVES:
        assert 0 < stepped.value(f"{curve} of the rotations, keys given", "error, cm") < held
    assert stepped.value("truth", "error, cm") == 0


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


def test_a_claim_is_confirmed_if_all_measures_are_better():
    measured = {ENDS: Validity(0, 0, 4, 0), ALONG: Validity(1, 1, 3, 1)}
    measured[STRAIGHT] = Validity(2, 2, 9, 2)
    claim = interpolation._claim("walks", measured)
    assert claim.fulfilled and "on 4 of 4 measures" in claim.figures
    measured[STRAIGHT] = Validity(2, 2, 4.5, 2)  # its jitter is nearer to the two motions'
    assert not interpolation._claim("walks", measured).fulfilled
    worse = interpolation._claim("walks", measured | {ALONG: measured[STRAIGHT]})
    assert "0 of 4 measures (none)" in worse.figures


def test_sampling_measures_priors_beside_real_motion(result_of):
    (table,) = result_of("sampling").tables
    assert table.value("test takes", BONES) < table.value("uniform prior", BONES)
    assert table.value("uniform prior", NEAREST) > table.value("fitted prior", NEAREST)
    uniform, fitted = result_of("sampling").claims
    assert not uniform.fulfilled and "fitted to encoded motion" in fitted.sentence
