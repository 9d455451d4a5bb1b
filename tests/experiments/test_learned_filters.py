"""The pictures of filters: every layer is there, and the untrained network is the one before."""

import numpy as np
import pytest

from numpy_cae.experiments.comparison.distances import untrained
from numpy_cae.experiments.filters.filters import filters
from numpy_cae.experiments.filters.responses import LIMBS


@pytest.fixture(scope="module")
def looked(small_manifold, labelled):
    return filters(small_manifold, labelled)


def test_every_layer_has_its_filters(looked):
    for look in (looked.trained, looked.before):
        assert [len(each.heard) for each in look.layers] == [12, 16]
        for each in look.layers:
            assert each.by_joint().shape[1] == 21
            np.testing.assert_allclose(each.by_limb().sum(axis=1), 1)
            assert np.all((each.joints() >= 1) & (each.joints() <= 20))
        assert 0 < look.alike < 1


def test_the_network_before_is_the_one_that_training_began_with(looked, small_manifold):
    before = untrained(small_manifold, small_manifold.settings["seed"]).network
    for layer, drawn in zip(before.layers, looked.before.weights, strict=True):
        np.testing.assert_array_equal(layer.w, drawn)
    now = looked.trained.weights[0]
    # Two epochs on eight takes: moved, but not far.
    assert 0.5 < np.corrcoef(now.ravel(), looked.before.weights[0].ravel())[0, 1] < 1


def test_text_findings_and_picture(looked, tmp_path):
    text = looked.text()
    for word in ("layer 2", *LIMBS):
        assert word in text
    said = looked.findings()
    assert len(said) == 4
    assert f"{looked.trained.alike:.2f}" in said[2].measured
    assert said[2].held == (looked.trained.alike < looked.before.alike)
    looked.save_picture(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 10_000
