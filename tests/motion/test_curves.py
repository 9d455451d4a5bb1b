"""Curves over holes: what is unknown in a rig, and how the ends of a hole join."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.motion import JOINTS
from numpy_cae.motion.hole_curves import CURVES, over_holes, rotations_over_holes
from numpy_cae.motion.joints import joint_mask
from numpy_cae.motion.quaternions import angle, from_vector, inverse, product
from numpy_cae.repair.interpolated import unknown_channels

LEG = "right_knee right_ankle right_toe", "rfemur rtibia rfoot"


@pytest.mark.parametrize(
    ("joints", "unknown"),
    [("left_wrist", "lradius"), ("left_elbow", "lhumerus"), ("left_collar", ""), LEG],
)
def test_a_rotation_is_unknown_if_all_its_bones_end_at_missing_joints(joints, unknown):
    walk = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    turned, moved = unknown_channels(walk, joint_mask(30, joints.split(), slice(10, 20)))
    names = [walk.skeleton.names[joint] for joint in np.flatnonzero(turned[15])]
    assert names == unknown.split()
    assert not turned[:10].any() and not turned[20:].any() and not moved.any()
    everything = unknown_channels(walk, joint_mask(30, JOINTS, slice(10, 20)))
    assert everything[0][10:20].all() and everything[1][10:20, 0].all()


@pytest.mark.parametrize("rate", [30.0, 120.0])
def test_a_short_hole_in_a_parabola_is_the_parabola(rate):
    """Its speed is measured exactly, and a cubic with these values and speeds is the parabola."""
    t = np.arange(round(2 * rate)) / rate
    values = (1 + 2 * t - 3 * t**2)[:, None, None]
    missing = (abs(t - 1) < 0.2)[:, None]
    filled = over_holes(np.where(missing[..., None], np.nan, values), missing, rate)
    np.testing.assert_array_equal(filled[~missing], values[~missing])
    np.testing.assert_allclose(filled, values, atol=1e-9)


def test_rotations_turn_beyond_half_a_turn():
    frames = np.arange(60.0)[:, None]
    turning = from_vector(0.1 * frames[..., None] * [1.0, 0.0, 0.0])
    missing = (frames >= 20) & (frames < 35)
    spoilt = np.where(missing[..., None], [0.0, 0.0, 0.0, 1.0], turning)
    for curve in CURVES.values():
        filled = rotations_over_holes(spoilt, missing, 30.0, lambda *_, curve=curve: curve)
        assert angle(product(inverse(filled), turning)).max() < 1e-6
