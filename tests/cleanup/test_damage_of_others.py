"""Synthetic motion with the damage of files of others: mended, left, or refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data_synth import draw_body, make_take
from numpy_cae.cleanup import PRESETS, repair_motion
from numpy_cae.cleanup.cuts import find_cuts
from numpy_cae.cleanup.feet import find_feet, mend_feet
from numpy_cae.cleanup.freezes import find_freezes
from numpy_cae.cleanup.measures import measure_damage
from numpy_cae.cleanup.view import View
from numpy_cae.motion.motion import Motion

BODY = draw_body(np.random.default_rng(1))


def clip(kind, seed=1, rate=30.0, seconds=3.0):
    return make_take(kind, seed, seconds, rate, body=BODY).motion


def turned(motion, joint, frames, degrees, axis="x"):
    """The motion with a joint of the rig turned in some frames."""
    rotations = motion.rotations.copy()
    index = motion.skeleton.index(joint)
    turn = Rotation.from_euler(axis, degrees, degrees=True)
    rotations[frames, index] = (Rotation.from_quat(rotations[frames, index]) * turn).as_quat()
    return replace(motion, rotations=rotations)


def moved(motion, frames, way):
    translations = motion.translations.copy()
    translations[frames, 0] += way
    return replace(motion, translations=translations)


def error_of(motion: Motion, truth: Motion) -> float:
    """The mean distance of the joints from the truth, centimetres."""
    distance = np.linalg.norm(motion.positions() - truth.positions(), axis=-1)
    return 100 * float(distance.mean())


@pytest.mark.parametrize("kilometres", [0.1, 3.4])
def test_first_frames_that_are_far_away_are_moved_back(kilometres):
    truth = clip("walk")
    damaged = moved(truth, slice(0, 3), [1000 * kilometres, 0.0, 0.0])
    assert error_of(repair_motion(damaged).motion, truth) < 2.0


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_body_that_steps_aside_for_some_frames_is_moved_back(seed):
    truth = clip("walk", seed, seconds=4.0)
    damaged = moved(moved(truth, slice(30, 36), [0.3, 0.0, 0.1]), slice(70, 78), [0.0, 0.2, 0.2])
    repaired = repair_motion(damaged).motion
    assert measure_damage(repaired).jumps < measure_damage(damaged).jumps
    assert error_of(repaired, truth) < 2.0


def test_a_hand_that_flips_now_and_then_is_mended_and_nothing_else_is_changed():
    truth = clip("walk", seconds=4.0)
    damaged = truth
    for first in (20, 50, 77, 101):
        damaged = turned(damaged, "lwrist", slice(first, first + 2), 170.0, "z")
    repaired = repair_motion(damaged)
    hand = truth.skeleton.index("lwrist")
    others = np.delete(np.arange(len(truth.skeleton.names)), hand)
    np.testing.assert_array_equal(repaired.motion.rotations[:, others], truth.rotations[:, others])
    angle = Rotation.from_quat(repaired.motion.rotations[:, hand]).inv()
    angle = (angle * Rotation.from_quat(truth.rotations[:, hand])).magnitude()
    assert np.degrees(angle).max() < 20.0


@pytest.mark.parametrize("frames", [(30, 31), (30, 34)])
def test_a_body_that_tumbles_for_a_moment_is_mended(frames):
    truth = clip("walk")
    damaged = turned(truth, "root", slice(*frames), 90.0)
    assert error_of(repair_motion(damaged).motion, truth) < 2.0


DAMAGES = {
    "spike": lambda motion: turned(motion, "lradius", 40, 70.0),
    "turn": lambda motion: turned(motion, "rhumerus", slice(30, 60), 40.0),
    "root elsewhere": lambda motion: moved(motion, slice(40, 50), [0.4, 0.0, 0.0]),
    "repeated": lambda motion: motion.at(np.r_[:40, [39] * 6, 46:90]),
    "on twos": lambda motion: motion.at(np.arange(90) // 2 * 2),
    "frozen": lambda motion: replace(
        motion,
        rotations=np.where(
            (np.arange(90) >= 40)[:, None, None]
            & (np.arange(90) < 60)[:, None, None]
            & (np.arange(motion.rotations.shape[1]) == motion.skeleton.index("lhumerus"))[:, None],
            motion.rotations[40],
            motion.rotations,
        ),
    ),
    "slides": lambda motion: moved(motion, slice(None), np.linspace(0, 1, 90)[:, None] * [1, 0, 0]),
}


@pytest.mark.parametrize("name", DAMAGES)
@pytest.mark.parametrize("preset", ["plain", *PRESETS])
def test_every_finding_can_be_written(name, preset):
    damaged = DAMAGES[name](clip("run"))
    settings = None if preset == "plain" else PRESETS[preset]
    for finding in repair_motion(damaged, preset=settings).listed():
        entry = json.loads(json.dumps(finding.to_json()))
        assert entry["frames"] == list(finding.frames)


@pytest.mark.parametrize("kind", ["walk", "run", "punch", "jumping_jacks", "squats"])
@pytest.mark.parametrize("rate", [24.0, 30.0, 60.0])
@pytest.mark.parametrize("seconds", [0.1, 0.2, 0.3])
def test_frames_that_were_lost_are_no_cut(kind, rate, seconds):
    motion = clip(kind, 3, rate, 4.0)
    first = round(1.6 * rate)
    rest = first + round(seconds * rate)
    assert find_cuts(View(motion.at(np.r_[:first, rest : len(motion)]))) == []


def test_a_trunk_and_arms_that_stand_still_while_the_body_walks_are_frozen():
    """As where the upper body was not captured at first: more than half of the rotations stand
    still, and the hips turn on."""
    motion = clip("walk", 2, 60.0)
    rotations = motion.rotations.copy()
    legs = ("root", "lhip", "lfemur", "ltibia", "lfoot", "rhip", "rfemur", "rtibia", "rfoot")
    upper = []
    for joint, name in enumerate(motion.skeleton.names):
        if not name.startswith(legs):
            upper.append(joint)
    rotations[50:80, upper] = rotations[50, upper]
    arm = [motion.skeleton.index(name) for name in ("lhumerus", "rhumerus")]
    turn = Rotation.from_euler("z", 60, degrees=True).as_quat()
    rotations[50:80, arm] = turn
    frozen = replace(motion, rotations=rotations)
    found = {finding.joint for finding in find_freezes(View(frozen)) if finding.kind == "frozen"}
    assert {"left_shoulder", "right_shoulder"} <= found


def test_a_foot_that_steps_at_the_start_is_held_from_its_place_on():
    """A foot goes back and forth by some centimetres before it stands: its stance begins then."""
    motion = clip("idle", 3, 30.0, 3.0)
    way = np.zeros(len(motion))
    way[:6] = [-0.10, -0.12, -0.12, -0.10, -0.05, -0.01]
    stepping = moved(motion, slice(None), way[:, None] * [0.0, 0.0, 1.0])
    findings = find_feet(View(stepping), sensitivity=1.0)
    assert all(finding.frames[0] >= 4 for finding in findings)
    held = mend_feet(View(stepping), findings)
    change = np.linalg.norm(held.positions() - stepping.positions(), axis=-1)
    assert change.max() < 0.04
