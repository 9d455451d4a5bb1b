"""What is no damage stays as it is: cuts between clips, held poses, joints at their limits.

Each test has, in synthetic motion, the property of a file of others that a repair once made worse.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from data_synth import draw_body, make_take
from numpy_cae.cleanup import PRESETS, Finding, repair_motion
from numpy_cae.cleanup.cuts import find_cuts
from numpy_cae.cleanup.feet import find_feet
from numpy_cae.cleanup.freezes import find_freezes
from numpy_cae.cleanup.repair import mend_damage
from numpy_cae.cleanup.result import join_motions
from numpy_cae.cleanup.view import View
from numpy_cae.manifold import starter

BODY = draw_body(np.random.default_rng(1))
RATES = [24.0, 30.0, 60.0, 120.0]


@pytest.fixture(scope="module")
def manifold():
    return starter()


def clip(kind, seed=1, rate=30.0, seconds=3.0):
    return make_take(kind, seed, seconds, rate, body=BODY).motion


def joined(*motions):
    motion = motions[0]
    for following in motions[1:]:
        motion = join_motions(motion, following)
    return motion


def eased_into_a_hold(motion, frame, frames):
    """The motion slowed down to a pose, which is then held for some frames."""
    slowing = frame - 8 + np.arange(8) - (np.arange(8) ** 2) // 12
    return motion.at(np.r_[: frame - 8, slowing, np.full(frames, slowing[-1])])


def assert_unchanged(repaired, motion):
    np.testing.assert_array_equal(repaired.motion.rotations, motion.rotations)
    np.testing.assert_array_equal(repaired.motion.translations, motion.translations)


@pytest.mark.parametrize(
    "rate", [24.0, *(pytest.param(rate, marks=pytest.mark.thorough) for rate in RATES[1:-1]), 120.0]
)
@pytest.mark.parametrize("kinds", [("punch", "kick", "walk"), ("squats", "idle"), ("wave", "run")])
def test_clips_in_one_file_are_cut_and_left_as_they_are(manifold, kinds, rate):
    clips = [clip(kind, seed, rate) for seed, kind in enumerate(kinds)]
    motion = joined(*clips)
    repaired = repair_motion(motion, manifold)
    assert repaired.cuts == tuple(len(clips[0]) * n for n in range(1, len(clips)))
    assert_unchanged(repaired, motion)


def test_a_cut_is_said():
    motion = joined(clip("punch"), clip("walk"))
    assert repr(repair_motion(motion)).startswith("cut at frame 90: ")


@pytest.mark.parametrize("kind", ["walk", "run", "kick", "jumping_jacks", "punch", "press_ups"])
@pytest.mark.parametrize("rate", RATES)
def test_one_clip_has_no_cut(kind, rate):
    assert find_cuts(View(clip(kind, 3, rate))) == []


@pytest.mark.parametrize("frames", [5, 10])
def test_frames_that_repeat_a_pose_are_no_cut(frames):
    motion = clip("walk")
    dropped = motion.at(np.r_[:40, [39] * frames, 40 + frames : 90])
    assert find_cuts(View(dropped)) == []
    assert {finding.kind for finding in repair_motion(dropped).findings} == {"repeated"}


def test_some_frames_of_another_pose_are_no_cut():
    motion = clip("walk")
    flashed = joined(
        motion.at(slice(40)), clip("squats").at(slice(20, 26)), motion.at(slice(46, 90))
    )
    assert find_cuts(View(flashed)) == []


def test_damage_in_a_clip_is_mended_as_in_a_file_of_its_own(manifold):
    walk = clip("walk", 4)
    walk.rotations[40:42, walk.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    alone = repair_motion(walk, manifold)
    after_punch = repair_motion(joined(clip("punch"), walk), manifold)
    np.testing.assert_array_equal(after_punch.motion.rotations[90:], alone.motion.rotations)
    (finding,) = alone.findings
    assert [found.frames for found in after_punch.findings] == [(130, 131)]
    assert finding.frames == (40, 41)


def test_findings_of_two_clips_passed_back_give_the_same_motion(manifold):
    walk = clip("walk", 4)
    walk.rotations[1:3, walk.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    walk.rotations[40:70, walk.skeleton.index("rhumerus")] = [0.5, 0.0, 0.0, np.sqrt(0.75)]
    motion = joined(clip("punch"), walk)
    repaired = repair_motion(motion, manifold)
    assert repaired.findings
    again = repair_motion(motion, manifold, findings=repaired.findings)
    np.testing.assert_array_equal(again.motion.rotations, repaired.motion.rotations)


def test_what_a_user_marks_across_a_cut_is_mended_across_it(manifold):
    motion = joined(clip("punch"), clip("walk"))
    marked = repair_motion(motion, manifold, findings=[Finding("body", (80, 99), "marked")])
    assert marked.cuts == () and marked.touched[80:100].all()


@pytest.mark.parametrize("seconds", [0.5, 1.0, 1.5, 3.0])
def test_a_pose_that_is_held_before_a_cut_is_left(manifold, seconds):
    """A body that dies, lies and is followed by another clip."""
    dies = eased_into_a_hold(clip("squats"), 60, round(30 * seconds))
    motion = joined(dies, clip("idle"))
    assert_unchanged(repair_motion(motion, manifold), motion)


@pytest.mark.parametrize("seconds", [0.5, 1.0, 2.75])
def test_a_pose_that_is_held_and_left_by_a_jump_is_left(manifold, seconds):
    """Keyed files hold a pose, and go on."""
    motion = clip("squats")
    hold = eased_into_a_hold(motion, 40, round(30 * seconds))
    motion = joined(hold, motion.at(slice(52, 90)))
    assert_unchanged(repair_motion(motion, manifold), motion)


def test_joints_that_are_held_together_are_not_frozen():
    """In a keyed hold only the head and a hand move on."""
    motion = clip("punch", 2, 30.0, 4.0)
    rotations = motion.rotations.copy()
    moving = [motion.skeleton.index(name) for name in ("head", "lwrist", "lowerneck")]
    still = np.setdiff1d(np.arange(rotations.shape[1]), moving)
    rotations[40:75, still] = rotations[40, still]
    rotations[75:, still] = motion.rotations[75:, still]
    held = replace(motion, rotations=rotations)
    assert [found for found in find_freezes(View(held)) if found.kind == "frozen"] == []


@pytest.mark.parametrize("seconds", [1.3, 2.0])
def test_a_rotation_frozen_for_more_than_a_second_is_not_interpolated(seconds):
    motion = clip("walk", 4, 30.0, 6.0)
    rotations = motion.rotations.copy()
    joint = motion.skeleton.index("lhumerus")
    frames = slice(60, 60 + round(30 * seconds))
    rotations[frames, joint] = Rotation.from_euler("z", 70, degrees=True).as_quat()
    frozen = replace(motion, rotations=rotations)
    repaired = repair_motion(frozen)
    assert_unchanged(repaired, frozen)
    proposals = [found for found in repaired.proposed if found.kind == "frozen"]
    assert [found.status for found in proposals] == ["proposed"]
    mended = repair_motion(frozen, findings=[replace(proposals[0], status="repaired")])
    assert mended.touched[90].any()


def straightened(motion, joint, frames):
    """The motion with a knee that comes to its limit once, by its own speed, and leaves it."""
    rotations = motion.rotations.copy()
    index = motion.skeleton.index(joint)
    angles = Rotation.from_quat(rotations[:, index]).as_euler("xyz")[:, 0]
    first, last = frames
    ramp = np.interp(np.arange(len(motion)), [first - 4, first, last, last + 4], [0.0, 1, 1, 0])
    bent = angles + np.radians(35)
    rotations[:, index] = Rotation.from_euler("x", (bent * (1 - ramp))[:, None]).as_quat()
    return replace(motion, rotations=rotations)


@pytest.mark.parametrize("rate", [30.0, 120.0])
def test_a_straight_knee_is_at_its_limit(rate):
    motion = clip("kick", 2, rate, 4.0)
    straight = straightened(motion, "ltibia", (round(1.5 * rate), round(1.8 * rate)))
    assert [found for found in find_freezes(View(straight)) if found.joint == "left_knee"] == []


def test_frames_that_hardly_move_are_no_finding():
    """Poses that are repeated while the body stands are printed as moving by 0.0 cm."""
    motion = clip("idle", 2, 120.0)
    frames = np.arange(len(motion))
    frames[100:140:4] = frames[99:139:4]
    assert mend_damage(motion.at(frames))[1] == []


def shuffling(metres, rate=60.0, seconds=12.0):
    """A person whose feet stand and shift by some centimetres now and then, without a step."""
    motion = clip("idle", 3, rate, seconds)
    times = np.arange(len(motion)) / rate
    way = np.zeros(len(motion))
    for number, when in enumerate((2.0, 4.5, 7.0, 9.5)):
        way += (-1) ** (number // 2) * metres * np.clip((times - when) / 0.3, 0.0, 1.0)
    translations = motion.translations.copy()
    translations[:, 0, 0] += way
    return replace(motion, translations=translations)


def test_feet_that_shuffle_and_hardly_slide_stay():
    motion = shuffling(0.07)
    repaired = repair_motion(motion, preset=PRESETS["suit"])
    assert_unchanged(repaired, motion)


def test_a_stance_ends_where_a_foot_changes_its_place():
    motion = shuffling(0.15)
    motion.translations[:, 0, 2] += 0.05 * np.arange(len(motion)) / 60.0  # it slides, besides
    for finding in find_feet(View(motion)):
        assert finding.frames[1] - finding.frames[0] < 2.6 * 60


def test_frames_that_are_dropped_twice_in_a_row_are_no_cut():
    motion = clip("run")
    assert find_cuts(View(motion.at(np.r_[:40, [39] * 8, [48] * 6, 54:90]))) == []


def test_fast_hops_on_a_smooth_curve_stay():
    """At 30 frames a second they look like jumps; at the 120 of the file they are a curve."""
    motion = make_take("idle", 2, seconds=4.0, rate=120.0).motion
    seconds = np.arange(480) / 120.0
    hops = np.where(seconds > 1.0, 0.3 * np.abs(np.sin(4.8 * np.pi * (seconds - 1.0))), 0.0)
    motion.translations[:, 0, 1] += gaussian_filter1d(hops, 2.0)
    assert repair_motion(motion).moved.max() == 0.0


def test_a_wrist_that_jumps_within_a_thirtieth_of_a_second_is_mended():
    """In steps of the file it moves on a line for four frames, and back."""
    motion = make_take("idle", 2, seconds=4.0, rate=120.0).motion
    wrist = motion.skeleton.index("lwrist")
    away = np.interp(np.arange(480), [236, 240, 244], [0.0, 0.3, 0.0], left=0.0, right=0.0)
    damaged = replace(motion, translations=motion.translations.copy())
    damaged.translations[:, wrist, 0] += away
    repaired = repair_motion(damaged)
    errors = [
        x.positions()[236:245, wrist] - motion.positions()[236:245, wrist]
        for x in (damaged, repaired.motion)
    ]
    assert np.abs(errors[1]).max() < 0.3 * np.abs(errors[0]).max()
