"""The 54 numbers of jang2018: their names, the conversion and its inverse, clips."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import JANG2018_KINDS, make_take
from numpy_cae.motion import (
    ANGLES,
    angles_of,
    body_positions,
    cut_clips,
    draw_clips,
    load_angles,
    motion_of,
    read_expmap,
)
from numpy_cae.motion.angle_table import HUMAN36M_TABLE, SEVENTEEN, TRANSLATION
from numpy_cae.motion.expmap_rigs import HUMAN36M
from numpy_cae.motion.retarget.rigs import with_joint_names


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
    found = angles_of(motion)
    assert found.numbers.shape == (100, 54)
    back = motion_of(found.numbers, found.table, found.offsets)
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
    for joint, axes in HUMAN36M_TABLE.rotating:
        columns += [3 + 3 * rows[joint] + "xyz".index(axis) for axis in axes]
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
    found = load_angles(path)
    assert found.table is HUMAN36M_TABLE and len(found) == 30  # every second of 50 a second
    assert np.allclose(found.numbers[:, ANGLES], -smooth[::2, ANGLES])
    assert np.allclose(found.numbers[:, TRANSLATION], 0.001 * smooth[::2, TRANSLATION])
    back = motion_of(found.numbers, found.table, found.offsets)
    truth = read_expmap(path).resampled(25)
    assert np.allclose(body_positions(back), body_positions(truth), atol=1e-9)


def test_without_a_neck_the_head_turns_as_one(walk, sequence):
    mapping = {"chest": "lowerneck", "left_collar": "lclavicle", "head": "upperneck"}
    found = angles_of(replace(walk, skeleton=with_joint_names(walk.skeleton, mapping)))
    head = [SEVENTEEN.columns.index(f"head {axis}") for axis in "xyz"]
    assert np.allclose(found.numbers[:, head], 0, atol=1e-7)
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
