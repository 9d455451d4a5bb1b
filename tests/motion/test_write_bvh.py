"""What is written reads back the same, opens in Blender, and never leaves half a file."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from numpy_cae.errors import FileError
from numpy_cae.motion import Motion, Skeleton, read_bvh, write_bvh
from numpy_cae.motion.formats import bvh_writer
from numpy_cae.motion.units import CMU_UNIT


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


def positions_by_name(motion: Motion) -> dict[str, np.ndarray]:
    return dict(zip(motion.skeleton.names, motion.positions().transpose(1, 0, 2), strict=True))


def assert_same_motion(one: Motion, other: Motion, within: float = 1e-5) -> None:
    assert one.rate == pytest.approx(other.rate, rel=1e-9)
    one_by_name, other_by_name = positions_by_name(one), positions_by_name(other)
    assert one_by_name.keys() == other_by_name.keys()
    for name, positions in one_by_name.items():
        np.testing.assert_allclose(positions, other_by_name[name], rtol=0, atol=within)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    joints=st.integers(1, 12),
    unit=st.sampled_from([1.0, 0.01, 0.001, CMU_UNIT, 0.0254, 3.0]),
)
def test_what_is_written_reads_back(tmp_path_factory, seed, joints, unit):
    path = tmp_path_factory.mktemp("written") / "take.bvh"
    motion = drawn_motion(seed, joints)
    write_bvh(motion, path, unit)
    again = read_bvh(path, unit)
    assert_same_motion(again, motion)
    for joint, name in enumerate(motion.skeleton.names):
        there = again.skeleton.index(name)
        np.testing.assert_allclose(
            again.skeleton.offsets[there], motion.skeleton.offsets[joint], atol=1e-6
        )
        if joint in motion.skeleton.end_sites:
            np.testing.assert_allclose(
                again.skeleton.end_sites[there], motion.skeleton.end_sites[joint], atol=1e-6
            )
        elif not motion.skeleton.children(joint):
            np.testing.assert_array_equal(again.skeleton.end_sites[there], [0, 0, 0])


@settings(max_examples=25, deadline=None)
@given(
    outer=st.floats(-180, 180),
    inner=st.floats(-180, 180),
    pole=st.sampled_from([90.0, -90.0]),
    beside=st.sampled_from([0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3]),
)
def test_poles_of_the_angles_lose_nothing(tmp_path_factory, outer, inner, pole, beside):
    path = tmp_path_factory.mktemp("pole") / "take.bvh"
    motion = drawn_motion(0, joints=5, frames=1)
    at_pole = Rotation.from_euler(
        "ZXY", [outer, pole - np.sign(pole) * beside, inner], degrees=True
    )
    rotations = np.tile(at_pole.as_quat(), (1, 5, 1))
    motion = replace(motion, rotations=rotations)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        write_bvh(motion, path)
        again = read_bvh(path, 0.01)
    assert_same_motion(again, motion, within=1e-5)


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

    def full_disk(*_arguments):
        yield "1 2 3"
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(bvh_writer, "_frame_lines", full_disk)
    with pytest.raises(FileError, match="cannot be written: No space left") as failed:
        write_bvh(drawn_motion(0), path)
    assert failed.value.path == path
    assert path.read_text() == "what was there"
    assert list(tmp_path.iterdir()) == [path]


def test_places_that_cannot_be_written_are_said(tmp_path):
    with pytest.raises(FileError, match="no folder"):
        write_bvh(drawn_motion(0), tmp_path / "nowhere" / "take.bvh")
    with pytest.raises(FileError, match="folder of this name"):
        write_bvh(drawn_motion(0), tmp_path)
    with pytest.raises(FileError, match="cannot be written"):
        write_bvh(drawn_motion(0), tmp_path / ("long" * 100 + ".bvh"))


def test_motions_that_bvh_cannot_hold_are_refused(tmp_path):
    path = tmp_path / "take.bvh"
    motion = drawn_motion(0)
    holed = motion.translations.copy()
    holed[3, 2, 1] = np.nan
    with pytest.raises(ValueError, match=r"translations.*frame 3, joint 'joint 2'"):
        write_bvh(replace(motion, translations=holed), path)
    with pytest.raises(ValueError, match="no frames"):
        write_bvh(motion.at(slice(0)), path)
    for name in ("", " hips", "a{b", "a\nb", "\ud800"):
        names = (name, *motion.skeleton.names[1:])
        with pytest.raises(ValueError, match="joint name"):
            write_bvh(replace(motion, skeleton=replace(motion.skeleton, names=names)), path)
    with pytest.raises(ValueError, match="unit is 0"):
        write_bvh(motion, path, unit=0)
    assert not list(tmp_path.iterdir())
