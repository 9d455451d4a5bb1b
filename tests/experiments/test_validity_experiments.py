"""Interpolation and sampling: the values of the tables are right, and claims follow from them."""

import numpy as np

from numpy_cae.evaluation import Validity
from numpy_cae.experiments import interpolation
from numpy_cae.experiments.interpolation import ALONG, ENDS, LINEAR
from numpy_cae.experiments.sampling import FITTED, REAL, UNIFORM

BONES, NEAREST = Validity.HEADER[0], Validity.HEADER[-1]


def test_interpolation_of_press_ups_and_walks(result_of, small_manifold, labelled):
    result = result_of("interpolation")
    press_ups, styles = result.tables
    assert "2 pairs" in press_ups.caption and "1 pairs" in styles.caption
    for table in result.tables:
        assert table.value(ENDS, BONES) < 0.5 < table.value(LINEAR, BONES)
    assert "press-ups" in result.claims[0].sentence
    assert result.claims[0].figures.startswith(f"{ALONG} is better than {LINEAR}")
    one, other = interpolation.clips_of_pair(small_manifold, *labelled.testing[:2])
    assert len(one) == len(other) == 32
    np.testing.assert_allclose(interpolation.linear(one, other, 0.5), (one + other) / 2)


def test_a_claim_holds_if_all_measures_are_better():
    measured = {
        ENDS: Validity(0, 0, 4.0, 0),
        ALONG: Validity(1, 1, 3.0, 1),
        LINEAR: Validity(2, 2, 9.0, 2),
    }
    assert len(interpolation.better_measures(measured, ALONG, LINEAR)) == 4
    assert interpolation.better_measures(measured, LINEAR, LINEAR) == []
    assert interpolation._claim(interpolation.PRESS_UPS, measured).confirmed
    measured[LINEAR] = Validity(2, 2, 4.5, 2)  # its jitter is nearer to the two motions'
    assert not interpolation._claim(interpolation.PRESS_UPS, measured).confirmed


def test_sampling_measures_priors_beside_real_motion(result_of):
    (table,) = result_of("sampling").tables
    assert table.value(REAL, BONES) < table.value(UNIFORM, BONES)
    assert table.value(UNIFORM, NEAREST) > table.value(FITTED, NEAREST)
    uniform, fitted = result_of("sampling").claims
    assert not uniform.confirmed and "fitted" in fitted.sentence
