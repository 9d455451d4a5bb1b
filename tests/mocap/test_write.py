"""Writing: BVH that reads back the same, a file's own text with changed numbers, tables.

Nothing leaves half a file.
"""

import os
import re
import subprocess
import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import AMC, ASF, FILES, write_acclaim
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from data_synth import make_take
from numpy_cae.errors import FileError
from numpy_cae.mocap import MotionFileError, load_motion, read_bvh, write_bvh
from numpy_cae.mocap.formats.rewriting import rewrite_numbers
from numpy_cae.mocap.units import CMU_UNIT
from numpy_cae.motion import Motion, Skeleton


def drawn_motion(seed: int, joints: int = 6, frames: int = 5, unit: float = 0.01) -> Motion:
    """Any tree, depth first or not; every other joint leaves its offset; every tip once in two."""
    rng = np.random.default_rng(seed)
    parents = (-1, *(int(rng.integers(0, joint)) for joint in range(1, joints)))
    skeleton = Skeleton(
        tuple(f"joint {joint}" for joint in range(joints)),
        parents,
        rng.normal(size=(joints, 3)),
        {joint: rng.normal(size=3) for joint in range(0, joints, 2)},
    )
    translations = np.tile(skeleton.offsets, (frames, 1, 1))
    translations[:, ::2] += rng.normal(size=translations[:, ::2].shape)
    turned = Rotation.random(frames * joints, random_state=seed).as_quat()
    return Motion(skeleton, 30.0, turned.reshape(frames, joints, 4), translations, unit)


LENGTHS = st.sampled_from([1.0, 0.01, 0.001, CMU_UNIT, 0.0254, 3.0])


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**31), joints=st.integers(1, 12), unit=LENGTHS)
def test_what_is_written_reads_back(tmp_path_factory, seed, joints, unit):
    path = tmp_path_factory.mktemp("written") / "take.bvh"
    motion = drawn_motion(seed, joints)
    write_bvh(motion, path, unit)
    again = read_bvh(path, unit)
    assert again.rate == pytest.approx(motion.rate, rel=1e-9)
    order = [motion.skeleton.index(name) for name in again.skeleton.names]
    assert sorted(order) == list(range(joints))
    np.testing.assert_allclose(again.positions(), motion.positions()[:, order], rtol=0, atol=1e-5)
    np.testing.assert_allclose(again.skeleton.offsets, motion.skeleton.offsets[order], atol=1e-6)
    for there, joint in enumerate(order):
        tip = motion.skeleton.end_sites.get(joint, np.zeros(3))
        if joint in motion.skeleton.end_sites or not motion.skeleton.children(joint):
            np.testing.assert_allclose(again.skeleton.end_sites[there], tip, atol=1e-6)


ANGLES, POLES = st.floats(-180, 180), st.sampled_from([90.0, -90.0])
DISTANCES = st.sampled_from([0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3])


@settings(max_examples=25, deadline=None)
@given(outer=ANGLES, inner=ANGLES, pole=POLES, distance=DISTANCES)
def test_poles_of_the_angles_lose_nothing(tmp_path_factory, outer, inner, pole, distance):
    path = tmp_path_factory.mktemp("pole") / "take.bvh"
    angles = [outer, pole - np.sign(pole) * distance, inner]
    at_pole = Rotation.from_euler("ZXY", angles, degrees=True).as_quat()
    motion = replace(drawn_motion(0, 1, frames=1), rotations=at_pole[None, None])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        write_bvh(motion, path)
        again = read_bvh(path, 0.01)
    gap = Rotation.from_quat(again.rotations[0]).inv() * Rotation.from_quat(at_pole)
    assert gap.magnitude().max() < 1e-6


def test_angles_run_on_without_leaps(tmp_path):
    motion = drawn_motion(2, joints=1, frames=100)
    turn = Rotation.from_euler("Y", np.linspace(0, 720, 100)[:, None], degrees=True)
    write_bvh(replace(motion, rotations=turn.as_quat()[:, None]), tmp_path / "take.bvh")
    rows = np.loadtxt((tmp_path / "take.bvh").read_text().splitlines()[-100:])
    assert np.abs(np.diff(rows[:, 3:], axis=0)).max() < 10


@pytest.mark.parametrize("seed", range(3))
def test_the_layout_is_what_blender_reads(tmp_path, seed):
    """One statement a line; '{', OFFSET and CHANNELS on the three lines after a joint; all
    rotations or none; 'Frames:' is two words, 'Frame Time:' three; every bone has an end."""
    path = tmp_path / "take.bvh"
    write_bvh(drawn_motion(seed, joints=9), path)
    lines = [line.split() for line in path.read_text().splitlines()]
    joints = [at for at, words in enumerate(lines) if words[0] in ("ROOT", "JOINT")]
    for at in joints:
        assert lines[at + 1] == ["{"]
        assert lines[at + 2][0] == "OFFSET" and len(lines[at + 2]) == 4
        assert lines[at + 3][0] == "CHANNELS" and int(lines[at + 3][1]) == len(lines[at + 3]) - 2
        assert sum("rotation" in channel for channel in lines[at + 3]) == 3
        assert lines[at + 4][0] in ("JOINT", "End"), "a bone without an end"
    end = lines.index(["MOTION"])
    assert all(words in (["{"], ["}"]) or len(words) > 1 for words in lines[1:end])
    assert lines[end + 1] == ["Frames:", "5"] and lines[end + 2][:2] == ["Frame", "Time:"]
    assert len(joints) == 9 and len(lines) == end + 3 + 5


def test_a_failed_write_leaves_what_was_there(tmp_path, monkeypatch):
    path = tmp_path / "take.bvh"
    path.write_text("what was there")

    def full_disk(file, *_arguments):
        file.write("1 2 3")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("numpy_cae.mocap.formats.write_bvh._write_rows", full_disk)
    with pytest.raises(FileError, match="cannot be written: No space left") as failed:
        write_bvh(drawn_motion(0), path)
    assert failed.value.path == path
    assert path.read_text() == "what was there"
    assert list(tmp_path.iterdir()) == [path]


def test_what_a_killed_process_left_is_removed_and_what_another_writes_is_not(tmp_path):
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    leftover, in_use = (tmp_path / f".take.{n}.part.bvh" for n in (ended.pid, os.getppid()))
    for path in (leftover, in_use, tmp_path / ".take.mine.part.bvh"):
        path.touch()
    write_bvh(drawn_motion(0), tmp_path / "take.bvh")
    assert not leftover.exists() and len(list(tmp_path.iterdir())) == 3


def test_lost_values_are_read_and_written_where_they_were_mended(tmp_path):
    path, new = tmp_path / "a.bvh", tmp_path / "new.bvh"
    lines = (FILES / "leg.bvh").read_text().splitlines(keepends=True)
    lines += ["nan 2 3 4 5 6 7 8 9\n", "1 2 3 4 -1.#IND00 6 7 8 9\n", "1 2 3 4 5 6 7 8 inf\n"]
    path.write_text("".join(lines))
    motion = load_motion(path)
    assert "not numbers (nan) in 3 frames, the first is frame 3" in motion.note
    with pytest.raises(ValueError, match="not finite: frame 4, joint 'Hips'"):
        motion.save(new)
    motion.at(np.zeros(6, int)).save(new)
    assert new.read_text().splitlines()[-6:] == ["1 2 3 4 5 6 7 8 9"] * 6


def test_places_that_cannot_be_written_are_said(tmp_path):
    with pytest.raises(FileError, match="no folder"):
        write_bvh(drawn_motion(0), tmp_path / "nowhere" / "take.bvh")
    (tmp_path / "folder.bvh").mkdir()
    with pytest.raises(FileError, match="folder of this name"):
        write_bvh(drawn_motion(0), tmp_path / "folder.bvh")


def test_motions_that_bvh_cannot_hold_are_refused(tmp_path):
    path = tmp_path / "take.bvh"
    motion = drawn_motion(0)
    holed = motion.translations.copy()
    holed[3, 2, 1] = np.nan
    for name, value, message in (
        ("translations", holed, r"translations.*frame 3, joint 'joint 2'"),
        ("translations", 1e12 * motion.translations, "expected less than 1e"),
        ("rate", 1e-9, "1e-09, expected 1 to 10000"),
        ("rate", 0, "above 0"),
    ):
        with pytest.raises(ValueError, match=message):
            write_bvh(replace(motion, **{name: value}), path)
    with pytest.raises(ValueError, match="no frames"):
        write_bvh(motion.at(slice(0)), path)
    for name in ("", " hips", "a{b", "a\nb", "\ud800", f"x:{motion.skeleton.names[1]}"):
        names = (name, *motion.skeleton.names[1:])
        with pytest.raises(ValueError, match="joint name"):
            write_bvh(replace(motion, skeleton=replace(motion.skeleton, names=names)), path)
    with pytest.raises(ValueError, match="unit is 0"):
        write_bvh(motion, path, unit=0)
    assert not list(tmp_path.iterdir())


@pytest.fixture
def odd(tmp_path):
    """Several separators, CRLF, a blank line, a wrap from 179 to -179 in frame 6."""
    text = (FILES / "odd.bvh").read_text()
    (tmp_path / "odd.bvh").write_bytes(text.replace("\n", "\r\n").encode())
    return tmp_path / "odd.bvh", load_motion(tmp_path / "odd.bvh", unit=0.01), tmp_path / "new.bvh"


def turned(motion, joint, frames, angle=0.2):
    rotations = motion.rotations.copy()
    more = Rotation.from_rotvec([0.0, angle, angle / 2])
    rotations[frames, joint] = (Rotation.from_quat(rotations[frames, joint]) * more).as_quat()
    return replace(motion, rotations=rotations)


def test_only_the_numbers_of_changed_rotations_and_translations_differ(odd):
    source, motion, path = odd
    rewrite_numbers(source, motion, motion, path)
    assert path.read_bytes() == source.read_bytes()
    after = turned(motion, 1, slice(3, 5))
    after = replace(after, translations=motion.translations.copy())
    after.translations[4, 0, 1] += 0.05
    rewrite_numbers(source, motion, after, path)
    texts = (file.read_bytes().decode().split("MOTION")[1] for file in (source, path))
    old, new = (re.split(r"(\s+)", text) for text in texts)
    assert len(old) == len(new)
    # Six words before the first frame: Frames:, 12, Frame, Time:, .0333333.
    changed = [divmod(place // 2 - 6, 12) for place in range(len(old)) if old[place] != new[place]]
    assert changed == [(3, 9), (3, 10), (3, 11), (4, 4), (4, 9), (4, 10), (4, 11)]
    again = load_motion(path, unit=0.01)
    np.testing.assert_allclose(again.positions(), after.positions(), atol=1e-5)


def test_where_the_start_is_cut_off_the_text_of_other_frames_is_kept(odd):
    source, motion, path = odd
    rewrite_numbers(source, motion, motion.at(slice(3, None)), path)
    old, new = (file.read_bytes().decode() for file in (source, path))
    last_lines = old.splitlines(keepends=True)[-10:]  # of nine frames, and a blank line
    assert new.endswith("".join(last_lines))
    assert "Frames:\t9\r\n" in new
    assert len(load_motion(path, unit=0.01)) == 9


def test_angles_jump_only_where_those_of_the_file_do(odd):
    source, motion, path = odd
    rewrite_numbers(source, motion, turned(motion, 0, slice(2, 9)), path)
    for file in (source, path):
        lines = file.read_text().split(".0333333")[1].split("\n")
        table = np.array([line.split() for line in lines if line.strip()], dtype=float)
        angles = table[:, [0, 1, 2, 9, 10, 11]]
        assert np.argwhere(np.abs(np.diff(angles, axis=0)) > 90).tolist() == [[3, 0]]


def test_an_acclaim_file_is_written_as_one(tmp_path):
    take = make_take("walk", 1, seconds=0.5, rate=30.0).motion
    source = tmp_path / "one.amc"
    write_acclaim(take, source)
    source.write_text("# by hand\n" + source.read_text().replace("\nlfemur", "  # hips\nlfemur", 3))
    motion = load_motion(source)
    rewrite_numbers(source, motion, motion, tmp_path / "same.amc")
    assert (tmp_path / "same.amc").read_bytes() == source.read_bytes()

    femur, tibia = (motion.skeleton.index(name) for name in ("lfemur", "ltibia"))
    after = turned(turned(motion, femur, [4, 5]), tibia, [5])
    rewrite_numbers(source, motion, after, tmp_path / "new.amc")
    texts = [path.read_text().splitlines() for path in (source, tmp_path / "new.amc")]
    changed = [
        old_line.split()[0]
        for old_line, new_line in zip(*texts, strict=True)
        if old_line != new_line
    ]
    assert changed == ["lfemur", "lfemur", "ltibia"]
    rewrite_numbers(source, motion, motion.at(slice(2, None)), tmp_path / "cut.amc")
    numbers = [line for line in (tmp_path / "cut.amc").read_text().splitlines() if line.isdigit()]
    assert numbers == [str(number) for number in range(1, 14)]
    again = load_motion(tmp_path / "new.amc")
    np.testing.assert_allclose(again.positions(), after.positions(), atol=1e-6)


def test_what_the_channels_do_not_allow_is_reported(tmp_path, caplog):
    (tmp_path / "02.asf").write_text(ASF)
    (tmp_path / "02_01.amc").write_text(AMC)
    motion = load_motion(tmp_path / "02_01.amc")
    after = turned(motion, motion.skeleton.index("tibia"), [1])  # which turns about x alone
    rewrite_numbers(tmp_path / "02_01.amc", motion, after, tmp_path / "new.amc")
    after = replace(after, translations=after.translations + 0.1)  # only the root has places
    rewrite_numbers(tmp_path / "02_01.amc", motion, after, tmp_path / "new.amc")
    assert "the channels do not allow it: hip 17 cm, femur 17 cm, tibia 12°" in caplog.text


def test_another_length_gives_a_whole_file_and_a_source_that_changed_is_refused(tmp_path):
    motion = make_take("walk", 1, seconds=0.5, rate=30.0).motion
    write_bvh(motion, tmp_path / "a.bvh")
    motion = load_motion(tmp_path / "a.bvh")
    with pytest.raises(ValueError, match="not finite"):
        holed = replace(motion, translations=motion.translations * np.nan)
        rewrite_numbers(tmp_path / "a.bvh", motion, holed, tmp_path / "b.bvh")
    short = motion.at(slice(0, 10))
    short.save(tmp_path / "short.bvh", motion)
    assert len(load_motion(tmp_path / "short.bvh")) == 10
    with pytest.raises(MotionFileError, match="has changed since it was read"):
        rewrite_numbers(tmp_path / "a.bvh", short, short, tmp_path / "b.bvh")
    with pytest.raises(ValueError, match=r"a\.fbx: a motion is written as \.bvh"):
        motion.save(tmp_path / "a.fbx")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.bvh", "short.bvh"]
