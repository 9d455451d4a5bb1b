"""Motions written as tables hold the positions of the motion."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.motion import write_motion


@pytest.fixture(scope="module")
def motion():
    return make_take("walk", 3, seconds=2.0, rate=30.0).motion


def test_tables_hold_the_positions(motion, tmp_path):
    write_motion(motion, tmp_path / "walk.npz")
    with np.load(tmp_path / "walk.npz") as archive:
        np.testing.assert_array_equal(archive["positions"], motion.positions())
        assert tuple(archive["names"]) == motion.skeleton.names
        assert archive["rate"] == 30
    write_motion(motion, tmp_path / "walk.csv")
    table = np.genfromtxt(tmp_path / "walk.csv", delimiter=",", names=True, deletechars="")
    head = motion.positions()[:, motion.skeleton.names.index("head"), 1]
    np.testing.assert_allclose(table["head_y"], head, atol=1e-6)
    np.testing.assert_allclose(table["time"], np.arange(len(motion)) / 30, atol=1e-6)


def test_another_suffix_is_refused(motion, tmp_path):
    with pytest.raises(ValueError, match=r"fbx: a motion is written as \.bvh, \.npz"):
        write_motion(motion, tmp_path / "walk.fbx")
