"""What is written as Acclaim reads back the same; what Acclaim cannot say is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from numpy_cae.motion import (
    Motion,
    MotionFileError,
    Skeleton,
    load_motion,
    read_amc,
    write_acclaim,
    write_amc,
    write_asf,
)
from numpy_cae.motion.io.units import CMU_UNIT


def drawn_motion(seed: int, joints: int = 7, frames: int = 4, rate: float = 120.0) -> Motion:
    """A tree of bones as Acclaim has them: all children of a joint sit at one place."""
    rng = np.random.default_rng(seed)
    parents = (-1, *(int(rng.integers(0, joint)) for joint in range(1, joints)))
    tips = rng.normal(size=(joints, 3))
    tips[0] = 0.0
    offsets = np.array([tips[parent] if parent >= 0 else rng.normal(size=3) for parent in parents])
    leaves = set(range(1, joints)) - set(parents)
    names = ("root", *(f"bone{joint}" for joint in range(1, joints)))
    skeleton = Skeleton(names, parents, offsets, {leaf: tips[leaf] for leaf in leaves})
    translations = np.tile(offsets, (frames, 1, 1))
    translations[:, 0] += rng.normal(size=(frames, 3))
    turned = Rotation.random(frames * joints, random_state=seed).as_quat()
    return Motion(skeleton, rate, turned.reshape(frames, joints, 4), translations)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**31),
    joints=st.integers(2, 12),
    unit=st.sampled_from([CMU_UNIT, 0.01, 1.0]),
    rate=st.sampled_from([120.0, 30.0, 59.94]),
)
def test_what_is_written_reads_back(tmp_path_factory, seed, joints, unit, rate):
    path = tmp_path_factory.mktemp("acclaim") / "take.amc"
    motion = drawn_motion(seed, joints, rate=rate)
    write_acclaim(motion, path, unit)
    again = load_motion(path)
    assert again.rate == pytest.approx(rate, rel=1e-9)
    assert again.unit == pytest.approx(unit, rel=1e-9)
    positions = dict(zip(again.skeleton.names, again.positions().swapaxes(0, 1), strict=True))
    for name, expected in zip(
        motion.skeleton.names, motion.positions().swapaxes(0, 1), strict=True
    ):
        np.testing.assert_allclose(positions[name], expected, rtol=0, atol=1e-5)
    for joint, tip in motion.skeleton.end_sites.items():
        there = again.skeleton.index(motion.skeleton.names[joint])
        np.testing.assert_allclose(again.skeleton.end_sites[there], tip, atol=1e-7)


def test_several_motions_share_a_skeleton(tmp_path):
    motion = drawn_motion(1)
    write_asf(motion.skeleton, tmp_path / "07.asf")
    for number in (1, 2):
        write_amc(motion, tmp_path / f"07_{number:02d}.amc")
    again = read_amc(tmp_path / "07_02.amc")
    assert len(again) == len(motion)


def test_same_motion_same_bytes(tmp_path):
    write_acclaim(drawn_motion(5), tmp_path / "a.amc")
    write_acclaim(drawn_motion(5), tmp_path / "b.amc")
    assert (tmp_path / "a.amc").read_bytes() == (tmp_path / "b.amc").read_bytes()
    assert (tmp_path / "a.asf").read_bytes() == (tmp_path / "b.asf").read_bytes()


def test_a_bone_with_two_ends_is_refused(tmp_path):
    offsets = np.array([[0, 0, 0], [0, 0, 0], [0, 1, 0], [1, 0, 0]], dtype=float)
    skeleton = Skeleton(("root", "back", "neck", "arm"), (-1, 0, 1, 1), offsets)
    with pytest.raises(ValueError, match="'back' sits in different places"):
        write_asf(skeleton, tmp_path / "a.asf")
    assert list(tmp_path.iterdir()) == []


def test_children_away_from_the_root_are_refused(tmp_path):
    skeleton = Skeleton(("root", "back"), (-1, 0), np.array([[0, 0, 0], [0, 1, 0]], dtype=float))
    with pytest.raises(ValueError, match="'root' sits in different places"):
        write_asf(skeleton, tmp_path / "a.asf")


def test_a_root_of_another_name_is_refused(tmp_path):
    skeleton = Skeleton(("Hips",), (-1,), np.zeros((1, 3)))
    with pytest.raises(ValueError, match="'Hips', expected 'root'"):
        write_asf(skeleton, tmp_path / "a.asf")


@pytest.mark.parametrize("name", ["left arm", "a,b", "#", "12", "a(b)"])
def test_names_that_a_reader_would_split_are_refused(tmp_path, name):
    skeleton = Skeleton(("root", name), (-1, 0), np.zeros((2, 3)))
    with pytest.raises(ValueError, match="joint name"):
        write_asf(skeleton, tmp_path / "a.asf")


def test_a_stretching_bone_is_refused(tmp_path):
    motion = drawn_motion(2)
    translations = motion.translations.copy()
    translations[3, 2, 0] += 0.01
    with pytest.raises(ValueError, match="'bone2' leaves its offset in frame 3"):
        write_amc(replace(motion, translations=translations), tmp_path / "a.amc")


def test_values_that_are_not_finite_are_refused(tmp_path):
    motion = drawn_motion(2)
    rotations = motion.rotations.copy()
    rotations[1, 3, 0] = np.nan
    with pytest.raises(ValueError, match="frame 1, joint 'bone3'"):
        write_amc(replace(motion, rotations=rotations), tmp_path / "a.amc")


def test_a_missing_folder_is_named(tmp_path):
    with pytest.raises(MotionFileError, match="there is no folder"):
        write_acclaim(drawn_motion(2), tmp_path / "nowhere" / "a.amc")


def test_a_real_motion_survives(data_folder, tmp_path):
    motion = load_motion(data_folder / "cmu" / "asfamc" / "02" / "02_01.amc")
    write_acclaim(motion, tmp_path / "again.amc")
    again = load_motion(tmp_path / "again.amc")
    assert again.skeleton.names == motion.skeleton.names
    np.testing.assert_allclose(again.positions(), motion.positions(), rtol=0, atol=1e-5)
