"""Damage that the file shows is found and mended; what shows nothing is left alone."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from data_synth import make_take
from numpy_cae.cleanup import PRESETS, Finding, Preset, repair_motion, write_findings
from numpy_cae.cleanup.feet import find_feet, mend_feet
from numpy_cae.cleanup.finding import check_finding, is_path
from numpy_cae.cleanup.freezes import find_t_pose
from numpy_cae.cleanup.interpolation import mark_missing_joints
from numpy_cae.cleanup.presets import fitting_preset
from numpy_cae.cleanup.repair import mend_damage
from numpy_cae.cleanup.view import View
from numpy_cae.manifold import starter
from numpy_cae.mocap import body_positions, rig_of
from numpy_cae.motion import JOINTS
from numpy_cae.motion.contacts import FEET, find_contacts
from numpy_cae.motion.filters import filter_motion, filter_strongly
from studies.shared.damages import DAMAGES, EASED, eased

LEG = [JOINTS.index(f"left_{joint}") for joint in ("knee", "ankle", "toe")]
LEGS_OF_RIG = [f"{side}{bone}" for side in "lr" for bone in ("hipjoint", "femur", "tibia", "foot")]
REST = [0.0, 0.0, 0.0, 1.0]


@pytest.fixture(scope="module")
def manifold():
    return starter()


@pytest.fixture(scope="module")
def walk():
    return make_take("walk", 77, seconds=5.0, rate=60.0).motion


def turned(motion, degrees, axis, frames=slice(None)):
    """The motion with joints of the rig, by name, turned about their own axis in some frames."""
    rotations = motion.rotations.copy()
    for joint, angle in degrees.items():
        index = motion.skeleton.index(joint)
        turn = Rotation.from_euler(axis, np.reshape(angle, (-1, 1)), degrees=True)
        rotations[frames, index] = (Rotation.from_quat(rotations[frames, index]) * turn).as_quat()
    return replace(motion, rotations=rotations)


def held(motion, joints, frames, value=None):
    """The rotations of joints of the rig held in some frames, at a value or at the first one's."""
    rotations = motion.rotations.copy()
    for joint in joints:
        index = motion.skeleton.index(joint)
        rotations[frames, index] = rotations[frames.start, index] if value is None else value
    return replace(motion, rotations=rotations)


def moved(motion, step, frames):
    translations = motion.translations.copy()
    translations[frames, 0] += step
    return replace(motion, translations=translations)


def error(motion, truth, frames, joints):
    off = body_positions(motion)[frames][:, joints] - body_positions(truth)[frames][:, joints]
    return np.linalg.norm(off, axis=-1).mean()


def assert_other_frames_are_kept(repaired, motion):
    untouched = ~repaired.touched.any(axis=1)
    np.testing.assert_array_equal(repaired.motion.rotations[untouched], motion.rotations[untouched])


SHOULDER, ALL = slice(101, 103), slice(None)
LATER, LAST = slice(200, None), slice(250, None)
DAMAGE = {
    "turned": (lambda m: turned(m, {"lfemur": 50.0}, "z", slice(120, 200)), slice(120, 200), 0.05),
    "spike": (lambda m: turned(m, {"lhumerus": 60.0}, "z", SHOULDER), SHOULDER, 0.02),
    "frozen": (lambda m: held(m, ["lhumerus", "lradius"], slice(120, 180)), slice(121, 180), 0.6),
    "frozen, at first": (lambda m: held(m, ["lhumerus"], slice(0, 60), REST), slice(0, 60), 0.4),
    "repeated": (lambda m: m.at(np.r_[:90, [89] * 15, 105:300]), slice(90, 105), 0.3),
    "root elsewhere": (lambda m: moved(m, [0.3, 0, 0.2], slice(200, None)), slice(200, None), 0.05),
    "root elsewhere, twice": (lambda m: moved(moved(m, 0.2, LATER), 0.3, LAST), LATER, 0.05),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_damage_is_found_and_mended_without_a_model(walk, kind):
    damage, frames, share = DAMAGE[kind]
    damaged = damage(walk)
    repaired = repair_motion(damaged, None)
    assert kind.split(",")[0] in {finding.kind for finding in repaired.findings}
    for finding in repaired.findings:
        last = len(walk) if frames.stop is None else frames.stop
        assert frames.start - 2 <= finding.frames[0] <= finding.frames[1] <= last + 1
        assert 0.5 <= finding.confidence <= 1 and finding.cm > 0
    assert error(repaired.motion, walk, frames, ALL) < share * error(damaged, walk, frames, ALL)
    assert_other_frames_are_kept(repaired, damaged)


def test_a_leg_turns_two_frames_after_a_step_of_its_own():
    """A step as long as the shortest jump, and the first jump of the turn, are no spike."""
    motion = make_take("walk", 0, seconds=5.0, rate=30.0).motion
    damaged = turned(motion, {"rfemur": 50.0}, "z", slice(50, 95))
    (finding,) = (found for found in mend_damage(damaged)[1] if found.joint == "right_hip")
    assert (finding.kind, finding.frames) == ("turned", (50, 94))


@pytest.mark.parametrize("onset", [1, pytest.param(2, marks=pytest.mark.thorough), 4])
@pytest.mark.parametrize("kind", EASED)
def test_damage_that_begins_over_a_few_frames_is_found(manifold, kind, onset):
    motion = make_take("walk", 4, seconds=6.0, rate=30.0).motion
    true = body_positions(motion)
    damaged, mask = DAMAGES[kind](motion, np.random.default_rng(1))
    damaged = eased(motion, damaged, mask, onset)
    repaired = repair_motion(damaged, manifold)
    found = mark_missing_joints(motion, repaired.findings)
    assert found[mask].mean() > 0.8 and found[~mask].mean() < 0.01
    share = 1.1 if kind == "frozen in channels" else 0.3  # arms that hang are filled in no better
    off = [np.linalg.norm(body_positions(m) - true, axis=-1) for m in (repaired.motion, damaged)]
    assert off[0][mask].mean() < share * off[1][mask].mean()
    if onset == 1:
        again = repair_motion(damaged, manifold, findings=repaired.findings).motion
        np.testing.assert_array_equal(again.rotations, repaired.motion.rotations)


def test_a_clean_motion_is_left_as_it_is(manifold, walk):
    for preset in (Preset(), Preset(feet=True)):
        repaired = repair_motion(walk, manifold, preset=preset)
        assert repaired.is_familiar and not repaired.findings
        assert repaired.motion is walk
    assert fitting_preset(walk) is None


def test_the_elbow_of_a_runner_at_24_frames_a_second_is_no_damage(walk):
    swing = [0, -19, -24, -13, -6, -7, -21, -44, -63, -58, -22, 32, 25, 4, 0]
    degrees = np.r_[np.zeros(100), swing, np.zeros(len(walk) - 115)]
    assert not mend_damage(turned(walk, {"lradius": degrees}, "x"))[1]


def test_hips_that_turn_for_a_kick_are_not_displaced(walk):
    kick = np.r_[np.zeros(120), np.linspace(60, 85, 40), np.full(len(walk) - 160, 39.0)]
    _, findings = mend_damage(turned(walk, {"root": kick}, "y"))
    assert "displaced" not in {finding.kind for finding in findings}


def test_a_pose_that_is_held_at_the_start_is_no_damage(walk):
    assert not mend_damage(walk.at(np.r_[[0] * 55, 2:300]))[1]


def on_twos(walk):
    """An animation in which every pose is held for two frames."""
    return replace(walk.at(np.repeat(np.arange(0, 300, 5), 2)), rate=24.0)


def with_a_turned_foot(walk):
    """A foot of which nothing says which half of its motion is turned."""
    return turned(walk, {"lfoot": 178.0}, "x", LATER)


@pytest.mark.parametrize("change", [on_twos, with_a_turned_foot])
def test_what_may_be_on_purpose_is_proposed_and_left(walk, change):
    motion = change(walk)
    mended, findings = mend_damage(motion)
    assert mended is motion and "proposed" in {finding.status for finding in findings}


def test_findings_of_poses_that_are_held_can_be_written(walk, tmp_path):
    _, findings = mend_damage(on_twos(walk))
    write_findings(tmp_path / "findings.json", findings)
    entries = json.loads((tmp_path / "findings.json").read_text("utf-8"))
    assert [Finding.from_json(entry).frames for entry in entries] == [f.frames for f in findings]


@pytest.mark.parametrize("rate", [24, 30, 60, 120])
@pytest.mark.parametrize("size", [0.5, 1.0, 2.0])
def test_a_kick_of_ten_metres_a_second_is_left_and_a_jump_beside_it_is_not(rate, size):
    walk = make_take("walk", 77, seconds=5.0, rate=120.0).motion
    kick = -100 * np.exp(-(((np.arange(len(walk)) / 120 - 2.0) / 0.08) ** 2))
    kick = turned(turned(walk, {"rfemur": kick}, "x"), {"rtibia": -0.7 * kick}, "x")
    kick = replace(kick.at(slice(None, None, 120 // rate)), skeleton=kick.skeleton.scaled(size))
    kick = replace(kick, rate=float(rate), translations=size * kick.translations)
    assert repair_motion(kick, None).motion is kick
    away = slice(4 * rate, 4 * rate + rate // 24)
    repaired = repair_motion(turned(kick, {"lhumerus": 60.0}, "z", away), None).motion
    assert np.abs(body_positions(repaired) - body_positions(kick)).max() < 0.05 * size


def test_findings_passed_back_are_mended_and_nothing_else(manifold, walk):
    damaged = turned(turned(walk, {"lhumerus": 60.0}, "z", SHOULDER), {"rfemur": 40}, "x", [200])
    findings = repair_motion(damaged, manifold).findings
    assert {finding.joint for finding in findings} >= {"left_shoulder", "right_hip"}
    chosen = [finding for finding in findings if finding.joint == "left_shoulder"]
    repaired = repair_motion(damaged, manifold, findings=chosen)
    assert np.flatnonzero(repaired.touched.any(axis=1)).tolist() == [101, 102]
    with pytest.raises(ValueError, match="no joint 'tail'"):
        repair_motion(walk, manifold, findings=[Finding("tail", (3, 4), "spike")])
    with pytest.raises(ValueError, match="frames 0 to 299"):
        repair_motion(walk, manifold, findings=[Finding("hips", (3, 300), "spike")])


def with_t_pose(walk, frames):
    """A T-pose in the first frames."""
    rotations, translations = walk.rotations.copy(), walk.translations.copy()
    rotations[:frames, 1:], translations[:frames] = REST, translations[0]
    return replace(walk, rotations=rotations, translations=translations)


T_POSES = pytest.mark.parametrize("frames", [1, 30])


@T_POSES
def test_a_t_pose_at_the_start_is_kept_and_not_smeared(walk, frames):
    damaged = with_t_pose(walk, frames)
    kept = repair_motion(damaged, None, preset=Preset(smooth=True))
    finding = kept.proposed[0]
    assert (finding.kind, finding.frames, finding.status) == ("T-pose", (0, frames - 1), "kept")
    np.testing.assert_array_equal(kept.motion.rotations[:frames], damaged.rotations[:frames])
    assert error(kept.motion, damaged, slice(frames, frames + 10), ALL) < 0.01


@T_POSES
def test_a_t_pose_at_the_start_is_cut_if_a_preset_says_so(walk, frames):
    damaged = with_t_pose(walk, frames)
    cut = repair_motion(damaged, None, preset=Preset(cut=True))
    np.testing.assert_array_equal(cut.motion.rotations, damaged.rotations[frames:])
    assert [f.status for f in cut.listed() if f.kind == "T-pose"] == ["repaired"]


@T_POSES
def test_the_preset_of_motion_with_a_t_pose_is_that_of_suits(walk, frames):
    assert fitting_preset(with_t_pose(walk, frames)) == "suit"


@T_POSES
def test_a_t_pose_from_which_a_filtered_file_eases_out_is_found(walk, frames):
    """After the root has turned."""
    damaged = with_t_pose(walk, frames)
    share = np.linspace(0.4, 0.0, 6)[:, None, None]
    after = damaged.rotations[frames : frames + 6, 1:]
    after += share * (REST - after)
    eases = turned(damaged, {"root": 90.0}, "y", slice(frames))
    assert find_t_pose(eases)[0].frames == (0, frames - 1)


@T_POSES
def test_a_t_pose_that_blends_into_the_motion_is_found(walk, frames):
    damaged = with_t_pose(walk, frames)
    share = np.array([0.5, 0.25, 0.1, 0.03, 0.0, 0.0])[:, None, None]  # over four frames
    after = damaged.rotations[frames : frames + 6, 1:]
    after += share * (REST - after)
    assert frames - 1 <= find_t_pose(damaged)[0].frames[1] < frames + 6


@pytest.mark.parametrize("way", [[0.0, -0.08, 0.0], [0.25, 0.0, 0.1]])
def test_feet_that_sink_or_slide_stand_still_on_the_floor(walk, way):
    """The body sinks into the floor, or slides there and back, without a jump."""
    frames = np.arange(len(walk))
    share = np.clip(np.minimum(frames - 90, 210 - frames) / 50, 0.0, 1.0)[:, None]
    translations = walk.translations.copy()
    translations[:, 0] += share * share * (3 - 2 * share) * way
    damaged = replace(walk, translations=translations)
    assert not repair_motion(damaged, None).findings
    repaired = repair_motion(damaged, None, preset=Preset(feet=True))
    assert {finding.kind for finding in repaired.findings} == {"foot"}
    contacts = find_contacts(body_positions(walk), 60.0)
    stands = contacts & (share == 1)
    toes = [body_positions(m)[:, FEET] for m in (walk, damaged, repaired.motion)]
    off = [np.linalg.norm(np.diff(x - toes[0], axis=0), axis=-1)[contacts[1:]] for x in toes[1:]]
    assert way[1] or off[1].mean() < 0.5 * off[0].mean()
    if way[1]:
        heights = [np.abs((x - toes[0])[..., 1])[stands].mean() for x in toes[1:]]
        assert heights[1] < 0.02 < 0.06 < heights[0]
    assert not (View(repaired.motion).jumps > 0).any()


def test_the_path_of_a_root_that_stands_still_follows_from_the_feet(walk):
    still = replace(walk, translations=walk.translations[:1].repeat(len(walk), axis=0))
    assert not repair_motion(still, None).findings
    repaired = repair_motion(still, None, preset=Preset(feet=True))
    true, after = body_positions(walk), body_positions(repaired.motion)
    off = np.linalg.norm(after[:, 0] - after[0, 0] - true[:, 0] + true[0, 0], axis=-1)
    assert is_path(repaired.findings[0])
    assert off.max() < 0.05 < 4.0 < np.linalg.norm(true[-1, 0] - true[0, 0])
    slides = np.linalg.norm(np.diff(after[:, FEET], axis=0), axis=-1)
    assert slides[find_contacts(true, 60.0)[1:]].mean() * 60.0 < 0.02
    assert np.abs(np.diff(after, 4, axis=0)).max() < 0.06  # no knee pops
    seated = turned(still, {"lfemur": -80.0, "rfemur": -80.0}, "x")
    upper = [joint for joint in walk.skeleton.names[1:] if joint not in LEGS_OF_RIG]
    cyclist = held(still, ["root", *upper], slice(0, None))
    assert not any(map(is_path, find_feet(View(seated)) + find_feet(View(cyclist))))


def test_feet_that_make_no_steps_are_held_at_one_place():
    wave = make_take("wave", 1, seconds=15.0, rate=30.0).motion
    still = replace(wave, translations=wave.translations[:1].repeat(len(wave), axis=0))
    noise = np.random.default_rng(0).normal(0.0, 15.0, size=(2, len(wave)))
    legs = dict(zip(["lfemur", "rfemur"], gaussian_filter1d(noise, 3.0), strict=True))
    after = repair_motion(turned(still, legs, "x"), None, preset=Preset(feet=True))
    assert is_path(after.findings[0])
    assert np.ptp(body_positions(after.motion)[:, 0, [0, 2]], axis=0).max() < 0.35


def test_feet_are_left_alone_where_they_would_slide_more(walk):
    """A finding that says that a foot stands while it swings."""
    speed = np.linalg.norm(np.gradient(body_positions(walk)[:, FEET[0]], axis=0), axis=-1)
    swing = 60 + int(np.argmax(speed[60:240]))
    wrong = [Finding("left_toe", (swing - 6, swing + 6), "foot")]
    assert mend_feet(View(walk), wrong) is walk
    repaired = repair_motion(walk, None, findings=wrong)
    assert not repaired.touched.any()
    assert [finding.status for finding in repaired.proposed] == ["left"]


def test_jumps_within_noise_are_removed_as_by_a_median_and_the_rest_is_kept(walk):
    noise = np.zeros(len(walk))
    noise[100:130] = 40 * np.random.default_rng(1).normal(size=30)
    noisy = turned(walk, {"lhumerus": noise}, "z")
    repaired = repair_motion(noisy, None)
    assert {"jumps"} == {finding.kind for finding in repaired.findings} - {"spike"}
    ten_lines = filter_motion(noisy, lambda curve: filter_strongly(curve, walk.rate))
    assert (View(noisy).jumps > 0).sum() > 10
    assert (View(repaired.motion).jumps > 0).sum() <= (View(ten_lines).jumps > 0).sum()
    moved = repaired.touched.any(axis=1)
    assert not moved[np.r_[:70, 160:300]].any()
    assert not repaired.touched[:, LEG].any()


def test_a_joint_that_returns_to_its_limit_is_not_frozen(walk):
    knees = held(held(walk, ["ltibia"], slice(60, 90)), ["ltibia"], slice(200, 203), REST)
    assert {"frozen"} == {f.kind for f in repair_motion(knees, None).findings} & {"frozen"}
    value = knees.rotations[60, walk.skeleton.index("ltibia")]
    at_limit = held(knees, ["ltibia"], slice(230, 240), value)
    assert "frozen" not in {
        f.kind for f in repair_motion(at_limit, None).findings if f.frames[0] < 95
    }


def test_a_bone_of_no_length_gets_its_length_back(walk):
    wrist, translations = walk.skeleton.index("lwrist"), walk.translations.copy()
    translations[100:160, wrist] = 0.0
    translations[200, wrist, 0] += 0.01  # so that the bone has a channel: no damage
    repaired = repair_motion(replace(walk, translations=translations), None)
    assert [finding.frames for finding in repaired.findings] == [(100, 159)]
    np.testing.assert_allclose(repaired.motion.translations[100:160], walk.translations[100:160])


def test_a_pose_that_begins_and_ends_smoothly_and_lasts_is_no_damage(manifold):
    """Someone kneels down, stays and stands up again: no model of walks knows it."""
    motion = make_take("walk", 4, seconds=8.0, rate=30.0).motion
    degrees = 100 * np.interp(np.arange(len(motion)), [60, 80, 150, 170], [0, 1, 1, 0])
    kneels = turned(motion, {"lfemur": -0.5 * degrees, "ltibia": degrees}, "x")
    assert not repair_motion(kneels, manifold).touched.any()


def test_an_unknown_motion_gets_what_needs_no_manifold(manifold):
    lying = make_take("idle", 1, seconds=3.0, rate=30.0).motion
    slow = np.linspace(0.0, 1.0, len(lying))[:, None, None]
    directions = np.random.default_rng(0).normal(size=(len(lying.skeleton.names), 3))
    turns = Rotation.from_rotvec((directions * (1 + 0.1 * slow)).reshape(-1, 3)).as_quat()
    strange = replace(lying, rotations=turns.reshape(lying.rotations.shape))
    repaired = repair_motion(strange, manifold)
    assert not repaired.is_familiar
    assert not repaired.touched.any()
    spiked = turned(strange, {"lhumerus": 60.0}, "z", slice(40, 41))
    repaired = repair_motion(spiked, manifold)
    assert not repaired.is_familiar
    assert np.flatnonzero(repaired.touched.any(axis=1)).tolist() == [40]
    marked = np.zeros((len(lying), 20), bool)
    marked[50:60] = True
    assert repair_motion(strange, manifold, marked).touched[50:60].all()


def test_values_that_are_not_finite_are_filled_in(manifold, walk):
    rotations, elbow = walk.rotations.copy(), walk.skeleton.index("lradius")
    rotations[50:60, elbow] = np.nan
    repaired = repair_motion(replace(walk, rotations=rotations), manifold)
    assert np.all(np.isfinite(repaired.motion.rotations))
    found = [(f.joint, f.frames, f.kind) for f in repaired.findings]
    assert found == [("left_elbow", (50, 59), "not finite")]
    assert error(repaired.motion, walk, slice(50, 60), [JOINTS.index("left_wrist")]) < 0.02
    assert_other_frames_are_kept(repaired, walk)


def test_a_motion_that_shakes_and_jumps_is_smoothed_about_as_by_ten_lines(walk):
    """The opponent is a median and a Butterworth filter on all rotations."""
    rng = np.random.default_rng(0)
    shaken = {name: 4 * rng.normal(size=len(walk)) for name in walk.skeleton.names[1:20]}
    noisy = turned(walk, shaken, "x")
    for frame in rng.integers(10, 290, 30):
        noisy = turned(noisy, {"lhumerus": 70.0}, "z", [frame])
    assert fitting_preset(noisy) == "video"
    repaired = repair_motion(noisy, None, preset=replace(PRESETS["video"], feet=False))
    ten_lines = filter_motion(noisy, lambda curve: filter_strongly(curve, walk.rate))
    assert error(repaired.motion, walk, ALL, ALL) < 1.2 * error(ten_lines, walk, ALL, ALL)
    assert (View(repaired.motion).jumps > 0).sum() <= (View(ten_lines).jumps > 0).sum()


@pytest.mark.parametrize("frames", [1, 2, 4, 7])
def test_short_motions_pass(walk, frames):
    assert len(mend_damage(walk.at(slice(frames)), PRESETS["video"])[0]) == frames


def test_our_name_of_a_joint_comes_before_a_joint_of_the_rig_of_that_name():
    """In VRM the joint `chest` is the one that we call the spine."""
    walk = make_take("walk", 0, seconds=1.0).motion
    names = [{"upperback": "chest"}.get(name, name) for name in walk.skeleton.names]
    renamed = replace(walk, skeleton=replace(walk.skeleton, names=tuple(names)))
    assert rig_of(renamed).joints[JOINTS.index("spine")] == names.index("chest")
    assert check_finding(renamed, Finding("chest", (0, 5))).joint == "chest"
    assert check_finding(renamed, Finding("thorax", (0, 5))).joint == "chest"


def test_every_step_says_which_share_of_the_time_has_passed(untrained_manifold):
    for preset, steps in ((None, 6), (PRESETS["video"], 8)):
        shares: list[float] = []
        motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
        repair_motion(motion, untrained_manifold, preset=preset, progress=shares.append)
        assert len(shares) == steps and sorted(set(shares)) == shares and 0 < max(shares) < 1
