"""Limbs that are turned, by turns that begin and end within a few hundredths of a second."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.cleanup import repair_motion
from numpy_cae.cleanup.quick_turns import find_quick_turns
from numpy_cae.cleanup.view import View
from numpy_cae.mocap import body_positions
from numpy_cae.motion.quaternions import from_vector, product


def turned(motion, bone, first, end, steps):
    """The motion with a bone turned by 50° from a frame to another, over some steps at each end."""
    frames = np.arange(len(motion))
    ends = [first - 1, first - 1 + steps, end - steps, end]
    share = np.interp(frames, ends, [0.0, 1.0, 1.0, 0.0])[:, None]
    joint = motion.skeleton.index(bone)
    rotations = motion.rotations.copy()
    turn = from_vector(share * np.radians([0.0, 0.0, 50.0]))
    rotations[:, joint] = product(rotations[:, joint], turn)
    return replace(motion, rotations=rotations)


@pytest.mark.parametrize("rate", [60.0, 90.0, 120.0])
@pytest.mark.parametrize(("bone", "name"), [("rfemur", "right_hip"), ("lhumerus", "left_shoulder")])
def test_a_turn_of_three_steps_is_found_and_undone(rate, bone, name):
    motion = make_take("walk", 4, seconds=5.0, rate=rate).motion
    first = round(2 * rate)
    end = round(2.7 * rate)
    damaged = turned(motion, bone, first, end, 3)
    repaired = repair_motion(damaged)
    (finding,) = repaired.findings
    assert (finding.joint, finding.kind) == (name, "limb turned quickly")
    assert finding.frames == (first, end - 1)
    true = body_positions(motion)
    off = np.linalg.norm(body_positions(repaired.motion) - true, axis=-1)
    assert off.max() < 0.1 * np.linalg.norm(body_positions(damaged) - true, axis=-1).max()


def test_the_same_findings_give_the_same_repair():
    motion = make_take("walk", 4, seconds=5.0, rate=60.0).motion
    damaged = turned(motion, "rfemur", 120, 162, 3)
    repaired = repair_motion(damaged)
    again = repair_motion(damaged, findings=repaired.findings)
    np.testing.assert_array_equal(again.motion.rotations, repaired.motion.rotations)


def test_a_turn_in_a_long_motion_is_found_once_whatever_block_it_is_in():
    motion = make_take("walk", 4, seconds=20.0, rate=60.0).motion
    for first in (340, 360, 700):  # a block has 360 frames
        (finding,) = find_quick_turns(View(turned(motion, "rfemur", first, first + 42, 3)))
        assert finding.frames == (first, first + 41)


@pytest.mark.parametrize("kind", ["kick", "punch", "run"])
@pytest.mark.parametrize("rate", [24.0, 120.0])
def test_fast_motion_has_none(kind, rate):
    motion = make_take(kind, 3, seconds=5.0, rate=rate).motion
    assert find_quick_turns(View(motion), sensitivity=0.8) == []


def test_short_motions_have_none():
    motion = make_take("walk", 3, seconds=5.0, rate=60.0).motion
    for frames in (1, 2, 5, 30):
        assert find_quick_turns(View(motion.at(slice(frames)))) == []
