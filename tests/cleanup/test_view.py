"""One view of a motion: what is computed once, and what is carried to the next version."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cleanup import repair_motion
from numpy_cae.cleanup.view import View
from numpy_cae.manifold import starter
from numpy_cae.motion.motion import Motion


@pytest.fixture(scope="module")
def walk():
    return make_take("walk", 77, seconds=8.0, rate=60.0).motion


@pytest.fixture
def kinematics(monkeypatch):
    """The numbers of frames of which forward kinematics was computed."""
    calls: list[int] = []
    compute = Motion.forward_kinematics

    def counted(motion, joints=None):
        calls.append(len(motion))
        return compute(motion, joints)

    monkeypatch.setattr(Motion, "forward_kinematics", counted)
    return calls


def changed(motion, frames, joint="lhumerus"):
    rotations = motion.rotations.copy()
    rotations[frames, motion.skeleton.index(joint)] = [0.6, 0.0, 0.0, 0.8]
    return replace(motion, rotations=rotations)


def damaged(motion):
    """A spike, an elbow that freezes for two thirds of a second, and a root that is elsewhere."""
    elbow = motion.skeleton.index("rradius")
    spiked = changed(motion, slice(101, 103))
    spiked.rotations[200:240, elbow] = spiked.rotations[200, elbow]
    translations = motion.translations.copy()
    translations[300:, 0] += [0.3, 0.0, 0.2]
    return replace(spiked, translations=translations)


def test_a_repair_of_eight_seconds_computes_forward_kinematics_twenty_times(walk, kinematics):
    motion = damaged(walk)
    manifold = starter()
    kinematics.clear()
    repaired = repair_motion(motion, manifold)
    assert {f.kind for f in repaired.findings} == {"spike", "frozen", "root elsewhere"}
    assert len(kinematics) <= 20


def test_what_a_view_has_computed_is_kept(walk, kinematics):
    view = View(walk)
    for _ in range(3):
        assert len(view.body) == len(view.toes) == len(view.jumps) == len(walk)
        assert view.size > 0 and view.channels and view.sliding >= 0
    assert kinematics == [len(walk)]


def test_only_the_poses_that_differ_are_computed_for_the_next_version(walk, kinematics):
    view = View(walk)
    assert len(view.body) == len(walk)
    after = changed(walk, slice(40, 45))
    assert len(view.after(after).body) == len(walk)
    assert kinematics == [len(walk), 5]


@pytest.mark.parametrize("frames", [slice(0, 3), slice(40, 45)])
def test_the_view_of_the_next_version_is_that_of_its_motion(walk, frames):
    view = View(walk)
    assert len(view.body) == len(walk)
    motion = changed(walk, frames)
    np.testing.assert_array_equal(view.after(motion).body, View(motion).body)


def test_the_same_motion_has_the_same_view(walk):
    view = View(walk)
    assert view.after(walk) is view


@pytest.mark.parametrize("rate", [30.0, 25.0])
def test_a_resampled_view_is_that_of_the_resampled_motion(walk, rate):
    view = View(walk)
    assert len(view.body) == len(walk)
    np.testing.assert_array_equal(view.resampled(rate).body, View(walk.resampled(rate)).body)


def test_jumps_of_some_frames_are_those_of_all(walk):
    view = View(changed(walk, slice(100, 102)))
    frames = np.r_[60:70, 95:110]
    expected = np.zeros(view.jumps.shape)
    expected[frames] = view.jumps[frames]
    assert expected.any()
    np.testing.assert_array_equal(view.jump_levels(frames), expected)


@pytest.mark.parametrize("size", [0.5, 2.0])
def test_a_body_of_any_size_is_seen_as_one_of_usual_size(walk, size):
    skeleton = walk.skeleton.scaled(size)
    scaled = replace(walk, skeleton=skeleton, translations=size * walk.translations)
    np.testing.assert_allclose(View(scaled).body, View(walk).body)
