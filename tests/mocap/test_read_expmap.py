"""Exponential-map text: layouts and conventions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from numpy_cae.mocap import load_motion
from numpy_cae.mocap.formats.expmap import CMU, HUMAN36M, cmu_root, read_expmap

seeds = st.integers(0, 2**32 - 1)


def write(path, rows):
    path.write_text("\n".join(",".join(f"{value:.9g}" for value in row) for row in rows) + "\n")
    return path


@pytest.mark.parametrize("rig", [CMU, HUMAN36M])
def test_each_joint_turns_by_its_own_three_numbers(tmp_path, rig):
    rng = np.random.default_rng(1)
    rows = rng.uniform(-0.5, 0.5, (4, rig.width))
    rows[:, 3:6] = 0  # the root of CMU's text has a test of its own
    motion = load_motion(write(tmp_path / "take.txt", rows), up="y", floor=0)
    assert motion.rate == rig.rate
    assert np.allclose(motion.translations[:, 0], rows[:, :3] * rig.unit)
    for row, name in zip(rig.joints[1:], rig.skeleton.names[1:], strict=True):
        turned = Rotation.from_quat(motion.rotations[:, motion.skeleton.index(name)])
        # The text's matrices are ours transposed.
        vectors = rows[:, 3 + 3 * row : 6 + 3 * row]
        assert np.allclose(turned.as_rotvec(), -vectors, atol=1e-7), name


@given(seeds)
def test_the_root_of_cmu_text_is_put_right(seed):
    """Angles that wander, multiplied in the text's order, come back in the database's."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, 200)[:, None]
    start, sway = rng.uniform(-0.3, 0.3, (2, 3))
    z, y, x = (start + sway * np.sin(6 * t)).T
    y = y + rng.uniform(-1.2, 1.2) + t[:, 0] * rng.uniform(-6, 6)
    text = Rotation.from_euler("ZXY", np.stack([z, x, y], axis=1))
    truth = Rotation.from_euler("ZYX", np.stack([z, y, x], axis=1))
    corrected = Rotation.from_quat(cmu_root(text.as_quat()))
    assert (corrected.inv() * truth).magnitude().max() < 1e-9


def test_cmu_text_agrees_with_the_acclaim_file(data_folder):
    """Trial 02_01 is there in both forms; the text's conversion lost the bone above Spine1."""
    text = read_expmap(data_folder / "cmu/expmap/walking/walking_1.txt")
    acclaim = load_motion(data_folder / "cmu/asfamc/02/02_01.amc")
    ours, theirs = text.positions()[1:], acclaim.positions()
    for name, bone in {"Hips": "root", "LeftFoot": "lfoot", "Spine1": "thorax"}.items():
        gap = ours[:, text.skeleton.index(name)] - theirs[:, acclaim.skeleton.index(bone)]
        assert np.abs(gap).max() < 1e-5, name


def test_a_unit_can_be_given(tmp_path):
    path = write(tmp_path / "take.txt", np.ones((3, 117)))
    assert np.allclose(read_expmap(path, unit=0.5).translations[:, 0], 0.5)
    with pytest.raises(ValueError, match="unit is 0"):
        read_expmap(path, unit=0)
