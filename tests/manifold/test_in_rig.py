"""A made motion in a rig that was brought: its skeleton, rate and unit stay."""

from __future__ import annotations

import numpy as np
import pytest
from numpy_cae.manifold.in_rig import in_rig, standing_still

from data_synth import make_take
from numpy_cae.manifold import MotionManifold
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion import RootTransform, body_of, bone_lengths


@pytest.mark.parametrize("rate", [20.0, 25.0, 30.0, 59.94, 120.0])
@pytest.mark.parametrize("frames", [1, 5, 6, 31, 60])
def test_a_rig_performs_its_own_motion_as_it_was(rate, frames):
    rig = make_take("walk", 2, seconds=3.0, rate=rate).motion
    body = body_of(rig)
    manifold = MotionManifold(ConvAutoencoder(), np.zeros(63), np.ones(63), bone_lengths(body))
    features, start = manifold.features(body)
    made = in_rig(manifold, features[:frames], start, rig)
    assert (made.skeleton, made.rate) == (rig.skeleton, rate)
    assert len(made) == pytest.approx(frames * rate / 30, abs=1)
    np.testing.assert_allclose(
        body_of(made), body[: len(body_of(made))], atol=1e-6 if rate == 30 else 0.02
    )


@pytest.mark.parametrize("rate", [25.0, 30.0, 120.0])
def test_a_rig_that_stands_still_is_as_long_as_was_asked(rate):
    rig = make_take("walk", 2, seconds=1.0, rate=rate).motion
    manifold = MotionManifold(
        ConvAutoencoder(), np.zeros(63), np.ones(63), bone_lengths(body_of(rig))
    )
    other = make_take("run", 5, seconds=3.0, rate=30.0).motion
    features, _ = manifold.features(body_of(other))
    made = in_rig(manifold, features, RootTransform(), standing_still(rig, len(features)))
    assert len(made) == pytest.approx(3 * rate, abs=1)
    np.testing.assert_allclose(body_of(made)[0, 0, [0, 2]], 0, atol=1e-9)
