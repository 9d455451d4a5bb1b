"""The 54 numbers of jang2018: the T-pose that is dropped, vectors without jumps, clips."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from data_synth import JANG2018_KINDS, make_take
from numpy_cae.mocap import angles_of, body_positions, load_angles, load_motion
from numpy_cae.mocap.formats.expmap import HUMAN36M, read_expmap
from numpy_cae.mocap.rigs.recognise import recognise_rig
from numpy_cae.mocap.t_pose import leading_t_pose
from numpy_cae.motion import cut_clips, draw_clips, motion_of
from numpy_cae.motion.angles import HUMAN36M_TABLE, SEVENTEEN, remove_whole_turns, unwrap
from numpy_cae.motion.clips import ANGLES, TRANSLATION


@pytest.fixture(scope="module")
def walk():
    return make_take("walking", 1, seconds=4.0).motion


@pytest.fixture(scope="module")
def sequence(walk):
    return angles_of(walk)


@pytest.mark.parametrize("kind", JANG2018_KINDS)
def test_there_and_back_on_another_rig(kind):
    """31 joints become 17; what is folded in costs a little, since offsets are the mean."""
    motion = make_take(kind, 2, seconds=4.0).motion
    angles = angles_of(motion)
    assert angles.numbers.shape == (100, 54)
    back = motion_of(angles.numbers, angles.table, angles.offsets)
    truth = body_positions(motion.resampled(25))
    assert np.linalg.norm(body_positions(back) - truth, axis=-1).mean() < 0.005


def test_there_and_back_on_its_own_rig_is_exact(sequence):
    back = motion_of(sequence.numbers, sequence.table, sequence.offsets)
    again = angles_of(back)
    assert np.allclose(again.numbers, sequence.numbers, atol=1e-9)
    assert np.allclose(again.offsets, sequence.offsets, atol=1e-9)


def test_the_fifty_four_columns_of_human36m_that_vary(tmp_path):
    """Text in which they and no others vary comes back through the 54 numbers as it was."""
    rows = dict(zip(HUMAN36M.skeleton.names, HUMAN36M.joints, strict=True))
    columns = [0, 1, 2]
    for joint, axis in map(str.split, HUMAN36M_TABLE.columns[3:]):
        columns.append(3 + 3 * rows[joint] + "xyz".index(axis))
    # The columns that MBR17's code is known to keep, counted from 0.
    assert columns == [
        *range(0, 10), *range(12, 16), *range(21, 25), *range(27, 31), *range(36, 48),
        *range(51, 58), *range(60, 63), *range(75, 82), *range(84, 87),
    ]  # fmt: skip
    rows = np.zeros((60, 99))
    smooth = np.cumsum(np.random.default_rng(0).normal(0, 0.05, (60, 54)), axis=0)
    rows[:, columns] = smooth
    path = tmp_path / "walking_1.txt"
    path.write_text("\n".join(",".join(map(repr, row.tolist())) for row in rows))
    angles = load_angles(path)
    assert angles.table is HUMAN36M_TABLE and len(angles) == 30  # every second of 50 a second
    assert np.allclose(angles.numbers[:, ANGLES], -smooth[::2, ANGLES])
    assert np.allclose(angles.numbers[:, TRANSLATION], 0.001 * smooth[::2, TRANSLATION])
    back = motion_of(angles.numbers, angles.table, angles.offsets)
    truth = read_expmap(path).resampled(25)
    assert np.allclose(body_positions(back), body_positions(truth), atol=1e-9)


def test_without_a_neck_the_head_turns_as_one(walk, sequence):
    mapping = {"chest": "lowerneck", "left_collar": "lclavicle", "head": "upperneck"}
    without_neck = angles_of(recognise_rig(walk, mapping))
    head = [SEVENTEEN.columns.index(f"head {axis}") for axis in "xyz"]
    assert np.allclose(without_neck.numbers[:, head], 0, atol=1e-7)
    assert not np.allclose(sequence.numbers[:, head], 0, atol=1e-3)


def test_clips_begin_anywhere_and_at_no_place(sequence):
    short = replace(sequence, numbers=sequence.numbers[:49] + 1000)
    clips = draw_clips([short, sequence], 40, np.random.default_rng(0))
    assert clips.shape == (40, 50, 54)
    assert np.array_equal(clips[:, 0, TRANSLATION], np.zeros((40, 3)))
    assert len(np.unique(clips[:, 0, 5])) > 20
    every = cut_clips([sequence], step=1)
    assert len(every) == len(sequence) - 49
    gaps = np.abs(clips[:, None] - every[None]).max(axis=(2, 3)).min(axis=1)
    assert gaps.max() < 1e-12


def wrapped(vectors):
    """As a reader of rotations gives them: none longer than π."""
    return Rotation.from_rotvec(vectors.reshape(-1, 3)).as_rotvec().reshape(vectors.shape)


@given(st.integers(0, 9999))
def test_the_same_rotations_without_a_jump(seed):
    rng = np.random.default_rng(seed)
    # Three joints that turn far about axes which drift slowly, never through no rotation at all.
    angle = rng.uniform(0.5, 9.0, 3) + np.linspace(0, 1, 100)[:, None] * rng.uniform(0, 9, 3)
    axis = rng.normal(size=(1, 3, 3)) + 0.002 * np.cumsum(rng.normal(size=(100, 3, 3)), axis=0)
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    smooth = angle[..., None] * axis
    continuous = unwrap(wrapped(smooth))
    assert np.allclose(wrapped(continuous), wrapped(smooth), atol=1e-9)
    steps = np.linalg.norm(np.diff(smooth, axis=0), axis=-1).max()
    assert np.linalg.norm(np.diff(continuous, axis=0), axis=-1).max() < 2 * steps + 1e-9


def test_an_exact_identity_on_the_way_keeps_the_turn():
    smooth = np.array([[0.0, 6.0, 0.0], [0.0, 2 * np.pi, 0.0], [0.0, 6.6, 0.0]])
    angle = wrapped(smooth)
    angle[1] = 0.0
    assert np.allclose(unwrap(np.concatenate([smooth[:1], angle[1:]])), smooth, atol=1e-9)


def test_what_does_not_jump_is_left_alone():
    calm = np.random.default_rng(0).normal(0, 0.2, (50, 4, 3))
    assert np.array_equal(unwrap(calm), calm)
    assert np.array_equal(remove_whole_turns(calm), calm)


@given(st.integers(0, 9999), st.integers(-3, 3))
def test_a_clip_forgets_turns_made_before_it(seed, turns):
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    clip = (rng.uniform(0.5, 2.5) + 0.2 * np.sin(np.linspace(0, 6, 50)))[:, None, None] * axis
    later = clip * (1 + 2 * np.pi * turns / np.linalg.norm(clip, axis=-1, keepdims=True))
    assert np.allclose(remove_whole_turns(later), clip, atol=1e-9)


@pytest.mark.parametrize("kind", JANG2018_KINDS)
def test_a_t_pose_is_dropped_and_a_first_frame_is_not(kind):
    """As the conversions of CMU put it: every joint at rest, the root where it starts."""
    motion = make_take(kind, 3, seconds=1.0).motion
    longer = motion.at(np.array([0, *range(len(motion))]))
    longer.rotations[0] = [0.0, 0.0, 0.0, 1.0]
    assert leading_t_pose(longer).frames == 1
    assert leading_t_pose(motion) is None


def test_someone_who_stands_in_a_t_pose_keeps_it():
    motion = make_take("idle", 0, seconds=1.0).motion
    rest = replace(motion, rotations=np.zeros_like(motion.rotations) + [0.0, 0.0, 0.0, 1.0])
    assert leading_t_pose(rest) is None


def test_every_cmu_text_has_one_and_only_one(data_folder):
    files = sorted((data_folder / "cmu/expmap").glob("*/*.txt"))
    for path in files[::4]:
        motion = load_motion(path)
        assert leading_t_pose(motion).frames == 1, path.name
        assert leading_t_pose(motion.at(slice(1, None))) is None, path.name
