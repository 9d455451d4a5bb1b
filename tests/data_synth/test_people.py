"""The parts that people are made of: bodies, joint limits, gait curves, inverse kinematics."""

import json
from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import FILES
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from data_synth import LIMITS, beyond_limits, joint_angles, make_body, make_take
from data_synth.two_bones import reach

REFUSED = json.loads((FILES / "synthetic.json").read_text(encoding="utf-8"))
seeds = st.integers(0, 2**31)


def test_a_body_is_as_tall_as_it_says():
    for stature in (1.5, 1.75, 2.0):
        body = make_body(stature)
        height = body.standing
        for name in ("upperback", "thorax", "lowerneck", "upperneck", "head"):
            height += body.offset(name)[1]
        height += body.skeleton.end_sites[body.skeleton.index("head")][1]
        assert height == pytest.approx(stature, rel=0.03)
        # Winter (2009), figure 4.1.
        assert body.leg == pytest.approx(0.491 * stature, rel=0.01)
        assert body.thigh / body.shank == pytest.approx(0.245 / 0.246, rel=0.01)
    with pytest.raises(ValueError, match="stature is 0"):
        make_body(0)


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_two_bones_reach_and_bend_to_one_side(seed):
    rng = np.random.default_rng(seed)
    upper, lower = rng.uniform(0.2, 0.6, 2)
    start, way = rng.normal(size=(5, 3)), rng.normal(size=(5, 3))
    way /= np.linalg.norm(way, axis=-1, keepdims=True)
    hinge = rng.normal(size=(5, 3))
    low, high = abs(upper - lower) / (upper + lower) + 0.02, 0.989
    share = rng.uniform(low, high, (5, 1))
    target = start + way * share * (upper + lower)
    middle, end = reach(start, target, upper, lower, hinge)
    np.testing.assert_allclose(end, target, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(middle - start, axis=-1), upper, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(end - middle, axis=-1), lower, atol=1e-9)
    side = np.cross(hinge, start - target)
    assert (np.sum((middle - start) * side, axis=-1) > -1e-12).all()
    # Too far away it stretches, and never beyond itself.
    _, end = reach(start, start + 3 * way, upper, lower, hinge)
    assert (np.linalg.norm(end - start, axis=-1) < upper + lower).all()


@pytest.mark.parametrize(("joint", "turn", "said"), REFUSED["limits"])
def test_a_joint_beyond_its_limits_is_named(joint, turn, said):
    motion = make_take("idle", 1, 0.5, 10.0).motion
    assert beyond_limits(motion) == []
    rotations = motion.rotations.copy()
    rotations[2, motion.skeleton.index(joint)] = Rotation.from_rotvec(turn).as_quat()
    found = beyond_limits(replace(motion, rotations=rotations))
    assert any(line.startswith(said) and "frame 2" in line for line in found), found


def test_every_joint_that_moves_has_limits():
    motion = make_take("waiting", 1, 6.0, 30.0).motion
    measured = {name for name, _ in joint_angles(motion)}
    stiff = {"root", "lhipjoint", "rhipjoint"}
    assert measured == set(motion.skeleton.names) - stiff
    for limits in LIMITS.values():
        assert all(low < high for low, high in limits.values())
