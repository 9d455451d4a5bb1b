"""Acclaim files: bones turn about their own axes, and a motion is read with its skeleton."""

import re
from itertools import permutations

import numpy as np
import pytest
from acclaim_files import AMC, ASF
from scipy.spatial.transform import Rotation

from numpy_cae.mocap import MotionFileError, load_motion
from numpy_cae.mocap.formats.amc import read_amc
from numpy_cae.mocap.units import CMU_UNIT


@pytest.fixture
def read_pair(tmp_path):
    def read(asf: str = ASF, amc: str = AMC, **arguments):
        (tmp_path / "02.asf").write_text(asf)
        (tmp_path / "02_01.amc").write_text(amc)
        return read_amc(tmp_path / "02_01.amc", **arguments)

    return read


def fixed(order: str, *angles: float) -> np.ndarray:
    """Rotations about fixed axes, the first letter's first."""
    return Rotation.from_euler(order, angles, degrees=True).as_matrix().reshape(3, 3)


def test_positions_are_those_of_explicit_matrices(read_pair):
    motion = read_pair()
    root = fixed("xyz", 10, 20, 30)
    c = fixed("xyz", 10, 20, 30)
    femur = root @ c @ fixed("xyz", 40, 50, 60) @ c.T
    c = fixed("xyz", 0, 0, 20)
    tibia = femur @ c @ fixed("x", 70) @ c.T
    at_root = np.array([1, 2, 3])
    at_hip = at_root + root @ [2, 0, 0]
    at_knee = at_hip + femur @ np.array([0.6, -0.8, 0]) * 7.5
    expected = CMU_UNIT * np.array([at_root, at_root, at_hip, at_knee, at_root])
    assert motion.skeleton.names == ("root", "hip", "femur", "tibia", "stump")
    np.testing.assert_allclose(motion.positions()[0], expected, atol=1e-12)
    positions, turned = motion.forward_kinematics()
    tip = positions[0, 3] + Rotation.from_quat(turned[0, 3]).apply(motion.skeleton.end_sites[3])
    np.testing.assert_allclose(tip, CMU_UNIT * (at_knee + tibia @ [0, -7, 0]), atol=1e-12)


def test_units_and_rate_come_from_the_files_unless_given(read_pair):
    motion = read_pair(ASF.replace("length 0.45", "length 2.54"))
    assert motion.unit == pytest.approx(0.01)
    assert motion.note.startswith("centimetres (:units of the skeleton: ")
    motion = read_pair(unit=0.1)
    assert motion.note.startswith("decimetres (as given")
    np.testing.assert_allclose(motion.translations[0, 0], [0.1, 0.2, 0.3])
    with_rate = AMC.replace(":DEGREES", ":DEGREES\n:SAMPLES-PER-SECOND 60")
    assert read_pair().rate == 120
    assert read_pair(amc=with_rate).rate == 60


def in_radians(text: str, *angles: float) -> str:
    """The text with these degrees, as they are written in it, in radians."""
    for angle in angles:
        text = re.sub(rf"\b{angle}\b", repr(float(np.radians(angle))), text)
    return text


def test_radians_are_read_where_each_file_says_so(read_pair):
    expected = read_pair().rotations[0]
    asf = ASF.replace("axis 10 20 30", in_radians("axis 10 20 30", 10, 20, 30))
    asf = asf.replace("0 0 20", in_radians("0 0 20", 20)).replace("angle deg", "angle rad")
    amc = AMC.replace("3 10 20 30", in_radians("3 10 20 30", 10, 20, 30))
    amc = amc.replace("femur 40 50 60", in_radians("femur 40 50 60", 40, 50, 60))
    amc = amc.replace("tibia 70", in_radians("tibia 70", 70)).replace(":DEGREES", ":RADIANS")
    for pair in ((asf, AMC), (ASF, amc), (asf, amc), (asf, amc.replace(":RADIANS\n", ""))):
        np.testing.assert_allclose(read_pair(*pair).rotations[0], expected, atol=1e-12)


@pytest.mark.parametrize("order", [" ".join(order) for order in permutations(("rx", "ry", "rz"))])
def test_dof_orders_values_and_rotations(read_pair, order):
    motion = read_pair(ASF.replace("dof rx ry rz", f"dof {order}"))
    c = fixed("xyz", 10, 20, 30)
    expected = c @ fixed(order.replace("r", "").replace(" ", ""), 40, 50, 60) @ c.T
    _, turned = motion.forward_kinematics()
    root = fixed("xyz", 10, 20, 30)
    matrix = Rotation.from_quat(turned[0, 2]).as_matrix()
    np.testing.assert_allclose(matrix, root @ expected, atol=1e-12)


def test_the_roots_order_position_and_orientation_are_honoured(read_pair):
    asf = ASF.replace("order TX TY TZ RX RY RZ", "order rz TZ ry TX rx TY")
    asf = asf.replace("position 0 0 0", "position 5 6 7").replace("axis XYZ", "axis YZX", 1)
    motion = read_pair(asf.replace("orientation 0 0 0", "orientation 11 12 13"))
    # The values 1 2 3 10 20 30 are now rz tz ry tx rx ty.
    expected = fixed("yzx", 12, 13, 11) @ fixed("zyx", 1, 3, 20)
    positions, turned = motion.forward_kinematics()
    np.testing.assert_allclose(Rotation.from_quat(turned[0, 0]).as_matrix(), expected, atol=1e-12)
    np.testing.assert_allclose(positions[0, 0], CMU_UNIT * np.array([5 + 10, 6 + 30, 7 + 2]))
    np.testing.assert_allclose(motion.skeleton.offsets[0], CMU_UNIT * np.array([5, 6, 7]))


def test_comments_blanks_the_first_frame_and_the_order_of_bones_do_not_matter(read_pair):
    expected = read_pair().positions()
    asf = ASF.replace("\n", " # so it is\n").replace("limits", "\nlimits").replace("\n", "\r\n")
    amc = AMC.replace("\n2\n", "\n\n# half way\n2\n").replace(" ", "\t").replace("\n", " # x\r\n")
    np.testing.assert_array_equal(read_pair(asf, amc).positions(), expected)
    amc = AMC.replace("\n1\n", "\n41\n").replace("\n2\n", "\n42\n").replace("\n3\n", "\n43\n")
    amc = amc.replace("femur 40 50 60\ntibia 70", "tibia 70\nfemur 40 50 60")
    np.testing.assert_array_equal(read_pair(amc=amc).positions(), expected)


def test_the_skeleton_is_found_by_the_subject(tmp_path):
    amc = tmp_path / "02_01.amc"
    amc.write_text(AMC)
    steps = (
        (None, 0, r"02_01.amc: .*no .asf file, expected 02.asf"),
        ("other.ASF", 4, None),
        ("another.asf", 5, r"another.asf, other.ASF, expected 02.asf"),
        ("02.asf", 2, None),
        ("02_01.asf", 8, None),
    )
    for name, length, problem in steps:
        if name:
            (tmp_path / name).write_text(ASF.replace("length 2", f"length {length}"))
        if problem:
            with pytest.raises(MotionFileError, match=problem):
                load_motion(amc)
        else:
            femur = load_motion(amc).skeleton.offsets[2, 0]
            assert femur == pytest.approx(length * CMU_UNIT)


def test_conventions_against_a_conversion_by_others(data_folder):
    """The BVH of trial 02_03 begins with an added T-pose; then both files agree to 0.001 of a
    unit from the lower spine down. Above, the conversion lost the thorax."""
    acclaim = load_motion(data_folder / "cmu" / "asfamc" / "02" / "02_03.amc")
    bvh = load_motion(data_folder / "cmu" / "bvh" / "02_03_first_frames.bvh")
    pairs = {"root": "Hips", "thorax": "Spine1", "lfoot": "LeftFoot", "rtoes": "RightToeBase"}
    frames = len(bvh) - 1
    assert frames == 3 and acclaim.rate == bvh.rate == 120 and acclaim.unit == bvh.unit == CMU_UNIT
    ours, theirs = acclaim.positions()[:frames], bvh.positions()[1:]
    for bone, joint in pairs.items():
        distance = ours[:, acclaim.skeleton.index(bone)] - theirs[:, bvh.skeleton.index(joint)]
        assert np.abs(distance).max() < 0.001 * CMU_UNIT, bone
