"""A T-pose before the first frame is dropped, and nothing else."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import JANG2018_KINDS, make_take
from numpy_cae.motion import load_motion, without_t_pose


def with_t_pose(motion):
    """As the conversions of CMU put it: every joint at rest, the root where it starts."""
    rest = np.zeros((1, *motion.rotations.shape[1:]))
    rest[..., 3] = 1.0
    return replace(
        motion,
        rotations=np.concatenate([rest, motion.rotations]),
        translations=np.concatenate([motion.translations[:1], motion.translations]),
    )


@pytest.mark.parametrize("kind", JANG2018_KINDS)
def test_a_t_pose_is_dropped_and_a_first_frame_is_not(kind):
    motion = make_take(kind, 3, seconds=1.0).motion
    dropped = without_t_pose(with_t_pose(motion))
    assert np.array_equal(dropped.rotations, motion.rotations)
    assert without_t_pose(motion) is motion


def test_someone_who_stands_in_a_t_pose_keeps_it():
    motion = make_take("idle", 0, seconds=1.0).motion
    rest = replace(motion, rotations=np.zeros_like(motion.rotations) + [0.0, 0.0, 0.0, 1.0])
    assert without_t_pose(rest) is rest


def test_every_cmu_text_has_one_and_only_one(data_folder):
    files = sorted((data_folder / "cmu/expmap").glob("*/*.txt"))
    for path in files[::4]:
        motion = load_motion(path)
        once = without_t_pose(motion)
        assert len(once) == len(motion) - 1, path.name
        assert without_t_pose(once) is once, path.name
