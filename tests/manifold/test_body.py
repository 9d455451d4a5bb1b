"""Body: features of a motion on the mean skeleton, and the way back into its rig."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.motion import UnknownRigError, body_of, body_positions, bone_lengths
from numpy_cae.motion.retarget.body import Body


@pytest.mark.parametrize("rate", [20.0, 25.0, 30.0, 59.94, 120.0])
@pytest.mark.parametrize("frames", [1, 5, 6, 31, 60])
def test_a_motion_returns_from_its_features(rate, frames):
    rig = make_take("walk", 2, seconds=3.0, rate=rate).motion
    body = Body(rig, bone_lengths(body_of(rig)) * 1.1)
    made = body.to_rig(body.features[:frames])
    assert (made.skeleton, made.rate) == (rig.skeleton, rate)
    assert len(made) == pytest.approx(frames * rate / 30, abs=1)
    truth = body.positions[: len(body_of(made))]
    np.testing.assert_allclose(body_of(made), truth, atol=1e-6 if rate == 30 else 0.02)


def test_features_are_those_of_the_manifold(untrained_manifold):
    motion = make_take("run", 1, seconds=2.0, rate=120.0).motion
    body = untrained_manifold.body(motion)
    features, root = untrained_manifold.features(body_of(motion))
    np.testing.assert_array_equal(body.features, features)
    assert body.root == root
    np.testing.assert_allclose(body.positions_of(features), body.positions, atol=1e-9)
    np.testing.assert_array_equal(body.positions_in_file, body_positions(motion))


def test_a_missing_joint_is_named_when_the_body_is_used(untrained_manifold):
    motion = make_take("walk", 0, 1.0).motion
    skeleton = replace(motion.skeleton, joint_names={"left_wrist": "tentacle"})
    body = untrained_manifold.body(replace(motion, skeleton=skeleton))
    with pytest.raises(UnknownRigError, match="tentacle"):
        _ = body.features
