"""Trial holes: the curve and the strength that a motion itself chooses."""

from dataclasses import replace

import numpy as np

from data_synth import make_take
from numpy_cae.mocap.retarget.body import Body
from numpy_cae.motion import JOINTS
from numpy_cae.motion.hole_curves import CURVES
from numpy_cae.motion.joints import joint_mask
from numpy_cae.motion.quaternions import angle, from_vector, inverse, product
from numpy_cae.repair.holes import PRIOR_TRIALS, curves_and_strengths, trials_in, weights
from numpy_cae.repair.interpolated import on_curves


def test_weights_fall_with_the_power_of_the_error_and_start_at_the_prior():
    prior = np.log([1.0, 2.0])
    np.testing.assert_allclose(weights(prior, np.empty((0, 2)), 3.0), [8 / 9, 1 / 9])
    trials = np.full((int(PRIOR_TRIALS), 2), [0.04, 0.02])  # as many as the prior counts for
    np.testing.assert_allclose(weights(prior, trials, 3.0), [0.5, 0.5])


def test_trials_are_the_hole_in_known_frames():
    pattern = np.full((12, 20), "", "U4")
    pattern[3:, JOINTS.index("left_wrist")] = "end"
    known = abs(np.arange(100) - 45.5) > 6
    kinds, starts, size = trials_in(known, pattern, 30.0)
    hidden = (kinds != "").any(axis=1)
    assert size == 12 and starts == [6, 58]
    assert not hidden[~known].any() and hidden.sum() == 9 * len(starts)
    for start in starts:
        np.testing.assert_array_equal(kinds[start : start + 12], pattern)
    assert trials_in(known[38:60], pattern, 30.0).starts == []


def test_a_motion_on_a_smooth_curve_is_filled_by_the_cubic(walk_manifold):
    """A shoulder that swings as a sine, which a cubic follows and slerp does not."""
    walk = make_take("walk", 3, seconds=6.0, rate=30.0).motion
    swing = 1.5 * np.sin(np.arange(180) / 6)[:, None] * [1.0, 0.0, 0.0]
    rotations, shoulder = walk.rotations.copy(), walk.skeleton.index("lhumerus")
    rotations[:, shoulder] = from_vector(swing)
    motion = replace(walk, rotations=rotations)
    hole = joint_mask(180, ["left_elbow", "left_wrist"], slice(80, 90))
    curve_at, strength = curves_and_strengths(
        walk_manifold, Body(motion, walk_manifold.lengths), hole
    )
    filled = {name: on_curves(motion, hole, lambda *_, c=c: c) for name, c in CURVES.items()}
    filled["chosen"] = on_curves(motion, hole, curve_at)
    for name, each in filled.items():
        filled[name] = angle(product(inverse(rotations), each.rotations))[80:90, shoulder].max()
    assert filled["chosen"] < min(0.2 * filled["slerp"], 1.5 * filled["cubic"])
    assert strength.shape == (180, 20) and not strength[~hole].any()
