"""Edits that a user asks for: on synthetic motion, and on files of others."""

import json
import shutil
from dataclasses import replace

import numpy as np
import pytest

from data_synth import draw_body, make_take
from numpy_cae.cleanup.edits import (
    filter_jitter,
    filter_low_pass,
    filter_median,
    hold_standing_feet,
    mirror_motion,
    split_at_cuts,
    trim_motion,
)
from numpy_cae.cleanup.result import join_motions
from numpy_cae.cli import main
from numpy_cae.mocap import body_positions, write_bvh
from numpy_cae.mocap.load import load_motion
from numpy_cae.motion import JOINTS, filters
from numpy_cae.motion.filters import median_of

BODY = draw_body(np.random.default_rng(1))
OTHER_SIDE = []
for _joint in JOINTS:
    side, _, name = _joint.partition("_")
    opposite = {"left": f"right_{name}", "right": f"left_{name}"}.get(side, _joint)
    OTHER_SIDE.append(JOINTS.index(opposite))
REAL = [
    "real/clean_freebvh.bvh",
    "real/clean_mocapbank.bvh",
    "real/video_pose_dance.bvh",
    "faults/kick_30fps.bvh",
    "cmu/asfamc/02/02_01.amc",
]
"""Files of five origins; the two sides of their rigs are mirror images."""


def clip(kind, seed=1, rate=30.0, seconds=3.0):
    return make_take(kind, seed, seconds, rate, body=BODY).motion


def assert_mirrored(motion, mirrored, metres):
    """The places of the joints from the hips are those of the other side, the sideways axis of
    the file negated."""
    body = body_positions(motion)
    expected = (body - body[:, :1])[:, OTHER_SIDE]
    after = body_positions(mirrored)
    after = after - after[:, :1]
    errors = []
    for axis in (0, 2):
        signs = np.ones(3)
        signs[axis] = -1.0
        errors.append(np.linalg.norm(after - signs * expected, axis=-1).max())
    assert min(errors) < metres


@pytest.mark.parametrize("kind", ["wave", "walk", "kick"])
def test_a_mirrored_motion_has_the_other_sides_places(kind):
    motion = clip(kind)
    assert_mirrored(motion, mirror_motion(motion), 1e-6)


def test_a_motion_that_is_mirrored_twice_is_the_motion():
    motion = clip("kick")
    again = mirror_motion(mirror_motion(motion))
    np.testing.assert_allclose(again.positions(), motion.positions(), atol=1e-9)


def test_a_rig_with_two_unlike_sides_is_not_mirrored():
    motion = clip("walk")
    offsets = motion.skeleton.offsets.copy()
    offsets[motion.skeleton.index("ltibia")] = [0.0, 0.0, 0.5]
    lying = replace(motion, skeleton=replace(motion.skeleton, offsets=offsets))
    with pytest.raises(ValueError, match="cannot be mirrored; retarget the motion to a rig whose"):
        mirror_motion(lying)


@pytest.mark.parametrize("name", REAL)
def test_files_of_others_are_mirrored(data_folder, tmp_path, name):
    motion = load_motion(data_folder / name)
    mirrored = mirror_motion(motion)
    assert_mirrored(motion, mirrored, 0.05)
    path = tmp_path / f"mirrored{(data_folder / name).suffix}"
    mirrored.save(path)
    written = load_motion(path)
    np.testing.assert_allclose(written.positions(), mirrored.positions(), atol=1e-3)


@pytest.mark.parametrize("hertz", [2.0, 6.0])
def test_a_low_pass_filter_changes_what_it_is_told_to(hertz):
    motion = clip("run")
    filtered = filter_low_pass(motion, hertz, ["left_elbow", "rtibia"], (20, 50))
    changed = np.argwhere(np.any(filtered.rotations != motion.rotations, axis=-1))
    names = {motion.skeleton.names[joint] for joint in changed[:, 1]}
    assert names == {"lradius", "rtibia"}
    assert changed[0, 0] == 20 and changed[:, 0].max() == 50


def test_a_low_pass_filter_removes_noise():
    motion = clip("walk", seconds=4.0)
    noise = 0.02 * np.random.default_rng(0).standard_normal((len(motion), 3))
    noisy = replace(motion, translations=motion.translations.copy())
    noisy.translations[:, 0] += noise
    filtered = filter_low_pass(noisy, 4.0)
    errors = [np.abs(m.translations - motion.translations).mean() for m in (noisy, filtered)]
    assert errors[1] < 0.6 * errors[0]


def test_a_median_removes_a_spike_and_fades_in_and_out():
    motion = clip("idle")
    motion.rotations[40, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    filtered = filter_median(motion, 2, ["left_elbow"], (30, 50), fade=0.1)
    values = filtered.rotations[:, motion.skeleton.index("lradius")]
    assert np.abs(np.diff(values[25:56], axis=0)).max() < 0.05


def test_a_filter_of_the_whole_motion_does_not_fade_however_long():
    motion = clip("walk")
    filtered = filter_low_pass(motion, 4.0, fade=1e308)
    expected = filter_low_pass(motion, 4.0, fade=0.0)
    np.testing.assert_array_equal(filtered.rotations, expected.rotations)


def test_medians_are_computed_in_parts(monkeypatch):
    values = np.random.default_rng(0).normal(size=(50, 3))
    expected = median_of(values, 7)
    monkeypatch.setattr(filters, "MEDIAN_VALUES", 2 * 15 * 3)
    np.testing.assert_array_equal(median_of(values, 7), expected)


def test_jitter_is_removed_from_named_joints_in_named_frames():
    motion = clip("walk", seconds=4.0)
    elbow = motion.skeleton.index("lradius")
    noise = 0.02 * np.random.default_rng(0).standard_normal((len(motion), 4))
    noisy = replace(motion, rotations=motion.rotations.copy())
    noisy.rotations[:, elbow] += noise
    noisy.rotations[:, elbow] /= np.linalg.norm(noisy.rotations[:, elbow], axis=-1, keepdims=True)
    smooth = filter_jitter(noisy, ["left_elbow"], (40, 80))
    changed = np.argwhere(np.any(smooth.rotations != noisy.rotations, axis=-1))
    assert set(changed[:, 1]) == {elbow} and {*changed[[0, -1], 0]} == {40, 80}
    inside = slice(45, 76)
    errors = [np.abs(x.rotations - motion.rotations)[inside, elbow] for x in (noisy, smooth)]
    assert errors[1].mean() < 0.6 * errors[0].mean()


def sliding_walk():
    """A walk of four seconds whose root drifts, so that its feet slide."""
    motion = clip("walk", seconds=4.0)
    motion.translations[:, 0, 0] += 0.2 * np.arange(120) / 30.0
    return motion


def test_named_feet_are_held_in_named_frames():
    motion = sliding_walk()
    held = hold_standing_feet(motion, ["left_toe"], (30, 70))
    moved = np.abs(held.positions() - motion.positions()).max(axis=(1, 2))
    assert moved[40:60].max() > 0.02 and max(moved[:15].max(), moved[86:].max()) < 0.002
    toe = JOINTS.index("left_toe")
    steps = [np.diff(body_positions(x)[:, toe, [0, 2]], axis=0) for x in (motion, held)]
    speeds = 30 * np.linalg.norm(steps, axis=-1)
    stands = (speeds[0] < 0.4) & (np.arange(119) > 34) & (np.arange(119) < 66)
    assert stands.sum() > 10
    assert np.median(speeds[1][stands]) < 0.5 * np.median(speeds[0][stands])


def test_hips_that_do_not_follow_the_feet_are_no_edit():
    motion = clip("walk", seconds=4.0)
    motion.translations[:, 0] = motion.translations[0, 0]
    with pytest.raises(ValueError, match="give the whole motion its path first"):
        hold_standing_feet(motion)


def test_a_knee_does_not_stand():
    with pytest.raises(ValueError, match="expected left_toe or right_toe"):
        hold_standing_feet(clip("walk"), ["left_knee"])


ON_A_PATH = [name for name in REAL if "video" not in name]
"""The files of `REAL` whose hips move with the feet."""
PARTS = [(name, "--smooth --joint left_wrist") for name in REAL]
PARTS += [(name, "--feet --joint right_toe") for name in ON_A_PATH]


@pytest.mark.parametrize(("name", "edit"), PARTS)
def test_a_part_of_files_of_others_is_smoothed_or_held(data_folder, tmp_path, name, edit):
    """What is not named keeps its text."""
    source = data_folder / name
    path = tmp_path / f"edited{source.suffix}"
    command = ["edit", str(source), "-o", str(path), *edit.split(), "--frames", "5", "25"]
    assert main(command) == 0
    before, after = load_motion(source), load_motion(path)
    differs = np.abs(after.positions() - before.positions()).max(axis=(1, 2)) > 1e-3
    assert not differs[60:].any()
    lines, edited = source.read_text().splitlines(), path.read_text().splitlines()
    assert lines[-1] == edited[-1]


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda motion: filter_low_pass(motion, 20.0), "expected 0.001 to 14.4"),
        (lambda motion: filter_low_pass(motion, 4.0, ["nose"]), "no joint 'nose'"),
        (lambda motion: filter_low_pass(motion, 4.0, None, (80, 95)), "the motion has 0 to 89"),
        (lambda motion: filter_median(motion, 0), "expected at least 1"),
        (lambda motion: filter_median(motion, 90), "the motion has 90 in all"),
        (lambda motion: trim_motion(motion, (5, 4)), "the motion has 0 to 89"),
    ],
)
def test_edits_name_what_is_wrong(edit, message):
    with pytest.raises(ValueError, match=message):
        edit(clip("walk"))


def test_a_part_of_a_file_keeps_its_numbers(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_bvh(clip("walk"), "walk.bvh", unit=0.01)
    assert main("edit walk.bvh -o part.bvh --trim --frames 20 49".split()) == 0
    lines = (tmp_path / "walk.bvh").read_text().splitlines()
    part = (tmp_path / "part.bvh").read_text().splitlines()
    assert "Frames: 30" in part
    assert part[-30:] == lines[-90:][20:50]


def test_clips_of_a_file_are_written_by_themselves(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    clips = [clip("punch"), clip("walk", 2), clip("squats", 3)]
    write_bvh(join_motions(join_motions(*clips[:2]), clips[2]), "clips.bvh", unit=0.01)
    assert main("edit clips.bvh -o parts --split".split()) == 0
    lines = (tmp_path / "clips.bvh").read_text().splitlines()[-270:]
    for number in (1, 2, 3):
        part = (tmp_path / "parts" / f"clips_{number}.bvh").read_text().splitlines()
        assert part[-90:] == lines[90 * number - 90 : 90 * number]


def test_no_clip_is_written_if_one_would_replace_the_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_bvh(join_motions(clip("punch"), clip("walk", 2)), "clips.bvh", unit=0.01)
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "clips_2.bvh").symlink_to(tmp_path / "clips.bvh")
    assert main("edit clips.bvh -o parts --split".split()) == 2
    assert "is the file that is read" in capsys.readouterr().err
    assert [path.name for path in (tmp_path / "parts").iterdir()] == ["clips_2.bvh"]


def test_a_file_without_a_cut_is_one_clip():
    motion = clip("walk")
    assert split_at_cuts(motion) == [motion]


def angles_in(path):
    lines = path.read_text().splitlines()
    first = next(n for n, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    return np.array([line.split() for line in lines[first:] if line.strip()], float)


def flipped(path, motion):
    """A file of a motion in which angles flip to others of the same rotation and make turns."""
    write_bvh(motion, path, unit=0.01)
    lines = path.read_text().splitlines()
    first = len(lines) - len(motion)
    for number in range(first, len(lines)):
        numbers = [float(word) for word in lines[number].split()]
        if number % 7 < 3:
            a, b, c = numbers[3:6]
            numbers[3:6] = [a + 180.0, 180.0 - b, c + 180.0]
        if number % 11 < 5:
            numbers[9] += 360.0
        lines[number] = " ".join(f"{value:.6f}" for value in numbers)
    path.write_text("\n".join(lines) + "\n")


def test_an_euler_filter_removes_flips_and_turns_and_keeps_the_motion(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "flips.bvh"
    flipped(path, clip("walk"))
    assert np.abs(np.diff(angles_in(path)[:, 3:], axis=0)).max() > 170
    assert main("edit flips.bvh -o plain.bvh --euler".split()) == 0
    assert np.abs(np.diff(angles_in(tmp_path / "plain.bvh")[:, 3:], axis=0)).max() < 60
    before, after = load_motion(path), load_motion(tmp_path / "plain.bvh")
    np.testing.assert_allclose(after.positions(), before.positions(), atol=1e-6)


@pytest.mark.parametrize("name", REAL[:4])
def test_an_euler_filter_of_files_of_others(data_folder, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    shutil.copy(data_folder / name, "file.bvh")
    assert main("edit file.bvh -o plain.bvh --euler".split()) == 0
    steps = np.abs(np.diff(angles_in(tmp_path / "plain.bvh"), axis=0))
    assert steps.max() < 150
    before, after = load_motion("file.bvh"), load_motion("plain.bvh")
    np.testing.assert_allclose(after.positions(), before.positions(), atol=1e-4)


@pytest.mark.parametrize("rate", [15, 24, 60])
@pytest.mark.parametrize("name", REAL)
def test_files_of_others_are_resampled(data_folder, tmp_path, name, rate):
    path = tmp_path / "resampled.bvh"
    assert main(["edit", str(data_folder / name), "-o", str(path), "--resample", str(rate)]) == 0
    motion, resampled = load_motion(data_folder / name), load_motion(path)
    assert resampled.rate == pytest.approx(rate)
    assert resampled.seconds == pytest.approx(motion.seconds, abs=2 / rate)


def test_contacts_are_a_list_that_can_be_edited(tmp_path, monkeypatch, capsys):
    """One command writes the stances, another holds those that are left in the list."""
    monkeypatch.chdir(tmp_path)
    write_bvh(sliding_walk(), "slides.bvh", unit=0.01)
    assert main("repair slides.bvh --feet --dry-run --findings contacts.json".split()) == 0
    contacts = json.loads((tmp_path / "contacts.json").read_text())
    stances = [entry for entry in contacts if entry["kind"] == "foot"]
    assert len(stances) > 4
    removed = max(stances, key=lambda entry: entry["frames"][0] if entry["frames"][1] < 90 else 0)
    left = [entry for entry in contacts if entry is not removed]
    (tmp_path / "edited.json").write_text(json.dumps(left))
    assert main("repair slides.bvh -o held.bvh --mask edited.json".split()) == 0
    before, after = (body_positions(load_motion(f"{name}.bvh")) for name in ("slides", "held"))
    speeds = []
    for entry in stances:
        first, last = entry["frames"]
        toe = JOINTS.index(entry["joint"])
        steps = [np.diff(body[first + 1 : last, toe], axis=0) for body in (before, after)]
        speeds.append([np.linalg.norm(step, axis=-1).mean() for step in steps])
    for entry, (slides, is_held) in zip(stances, speeds, strict=True):
        if entry is removed:
            assert is_held > 0.5 * slides
        else:
            assert is_held < 0.4 * slides
