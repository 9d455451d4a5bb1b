"""The unit of a BVH file is guessed from its bones, whatever the pose and wherever the root."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.motion import Skeleton, load_motion, write_bvh
from numpy_cae.motion.units import TIP_TO_TIP, UNITS, guess_unit, stated_unit, stature


def test_the_longest_way_from_tip_to_tip():
    #   root - hips - leg - (toe)        10 below the hips the root counts in no way
    #               - spine - (head), spine - arm - (finger)
    skeleton = Skeleton(
        ("root", "hips", "leg", "spine", "arm"),
        (-1, 0, 1, 1, 3),
        np.array([[0, 0, 0], [10, 0, 0], [0, 3, 0], [4, 0, 0], [0, 0, 5]], dtype=float),
        {2: np.array([1.0, 0, 0]), 3: np.array([2.0, 0, 0]), 4: np.array([0, 0.5, 0])},
    )
    assert stature(skeleton) == pytest.approx((1 + 3 + 4 + 5 + 0.5) / TIP_TO_TIP)


@pytest.mark.parametrize("name", UNITS)
@given(tall=st.floats(1.4, 2.0))
@settings(max_examples=20)
def test_a_grown_person_is_measured_in_the_right_unit(name, tall):
    height = tall / UNITS[name]
    unit, note = guess_unit(height)
    assert unit == UNITS[name]
    tall = height * unit
    assert note == f"{name} (guessed: the skeleton is about {tall:.1f} m tall)"


def test_giants_and_dwarfs_are_doubted():
    assert guess_unit(4.0)[1].endswith("about 4.0 m tall, which no adult is; give the right unit)")
    assert "give the right unit" in guess_unit(20_000.0)[1]
    assert guess_unit(0.0) == (1.0, "metres (assumed: the skeleton has no two limbs to measure)")


@pytest.mark.parametrize(
    "take",
    ["cmu/bvh/02_03_first_frames.bvh", "bandai/dataset-2_run_normal_001.bvh"]
    + [f"cmu/asfamc/{trial}" for trial in ("01/01_01.amc", "02/02_01.amc", "03/03_01.amc")],
)
def test_real_skeletons_in_any_unit_are_measured_right(data_folder, tmp_path, take):
    short = load_motion(data_folder / take).at(slice(5))
    for unit in UNITS.values():
        write_bvh(short, tmp_path / "take.bvh", unit)
        assert load_motion(tmp_path / "take.bvh").unit == unit
    assert stated_unit(0.01, "as given", 0.0).startswith("centimetres (as given")
    assert "no adult" not in stated_unit(0.01, "as given", 1.8)
    assert "18.2 m tall, which no adult is" in stated_unit(0.1, "as given", 18.2)
