"""The twenty joints are found in every known rig and by mapping in others; resampling."""

import json

import numpy as np
import pytest

from numpy_cae.motion import (
    JOINTS,
    Motion,
    Skeleton,
    UnknownRigError,
    bone_lengths,
    find_joints,
    load_body,
    read_mapping,
)
from numpy_cae.motion.retarget.rigs import RIGS


def skeleton_of(names):
    parents = tuple(index - 1 for index in range(len(names)))
    return Skeleton(tuple(names), parents, np.zeros((len(names), 3)))


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("dress", [str, str.upper, lambda name: f"mixamorig:{name}"])
def test_each_rig_is_found_among_other_joints(rig, dress):
    names = [dress(RIGS[rig][joint]) for joint in JOINTS]
    skeleton = skeleton_of(["world", *names, "a tail"])
    found = find_joints(skeleton)
    assert [skeleton.names[index] for index in found] == names


def test_a_missing_joint_lists_what_the_rig_has():
    names = [name for name in RIGS["Bandai"].values() if name != "Hand_L"]
    with pytest.raises(UnknownRigError) as error:
        find_joints(skeleton_of(names))
    assert "left_wrist (as 'Hand_L')" in str(error.value)
    assert "UpperArm_R" in str(error.value)


def test_a_users_mapping_goes_before_the_table(tmp_path):
    names = [name if name != "Hand_L" else "paw" for name in RIGS["Bandai"].values()]
    file = tmp_path / "rig.json"
    file.write_text(json.dumps({"left_wrist": "paw"}))
    skeleton = skeleton_of(names)
    found = find_joints(skeleton, read_mapping(file))
    assert skeleton.names[found[JOINTS.index("left_wrist")]] == "paw"


@pytest.mark.parametrize("text", ["{", "[1]", '{"hips": 3}', '{"tail": "x"}'])
def test_an_invalid_mapping_is_refused_with_its_file(tmp_path, text):
    file = tmp_path / "rig.json"
    file.write_text(text)
    with pytest.raises(UnknownRigError, match=r"rig\.json: (not JSON|expected an obj|not among)"):
        read_mapping(file)


@pytest.mark.parametrize(
    ("file", "stature"),
    [
        ("bandai/dataset-2_walk_normal_001.bvh", (1.3, 1.7)),
        ("cmu/asfamc/02/02_01.amc", (1.5, 1.9)),
        ("cmu/bvh/02_03_first_frames.bvh", (1.4, 1.9)),
    ],
)
def test_real_rigs_stand_upright_with_their_left_on_the_left(data_folder, file, stature):
    positions, motion = load_body(data_folder / file)
    assert motion.rate > 0
    at = dict(zip(JOINTS, positions.transpose(1, 0, 2), strict=True))
    tall = at["head"][:, 1] - np.minimum(at["left_toe"][:, 1], at["right_toe"][:, 1])
    assert stature[0] - 0.25 < np.median(tall) < stature[1]
    lengths = dict(zip(JOINTS, bone_lengths(positions), strict=True))
    for bone in ("knee", "ankle", "elbow", "wrist", "toe"):
        assert lengths[f"left_{bone}"] == pytest.approx(lengths[f"right_{bone}"], rel=0.08)
    # Facing along (across × up), the toes lie before the ankles.
    across = at["left_hip"] - at["right_hip"]
    forward = np.cross(across, [0, 1, 0])
    toes = at["left_toe"] + at["right_toe"] - at["left_ankle"] - at["right_ankle"]
    assert np.median(np.sum(toes * forward, axis=1)) > 0


def test_resampling_sub_samples_and_interpolates():
    skeleton = skeleton_of(["a", "b"])
    frames = 13
    turn = np.zeros((frames, 2, 4))
    angles = np.linspace(0, 1.2, frames)
    turn[:, :, 1], turn[:, :, 3] = np.sin(angles / 2)[:, None], np.cos(angles / 2)[:, None]
    shift = np.linspace(0, 1, frames)[:, None, None] * np.ones((1, 2, 3))
    motion = Motion(skeleton, 120.0, turn, shift)
    fourth = motion.resampled(30)
    assert fourth.rate == 30
    np.testing.assert_array_equal(fourth.translations, shift[::4])
    odd = motion.resampled(50)
    assert len(odd) == 6
    np.testing.assert_allclose(odd.translations[:, 0, 0], np.arange(6) / 50 * 10)
    np.testing.assert_allclose(2 * np.arcsin(odd.rotations[:, 0, 1]), np.arange(6) / 50 * 12)
    assert len(Motion(skeleton, 24.0, turn, shift).resampled(30)) == 16


def test_a_rounded_frame_time_is_the_same_rate():
    skeleton = skeleton_of(["a"])
    turn = np.tile([0.0, 0, 0, 1], (9, 1, 1))
    motion = Motion(skeleton, 1 / 0.0083333, turn, np.zeros((9, 1, 3)))
    assert len(motion.resampled(30)) == 3
    ntsc = Motion(skeleton, 29.97, turn, np.zeros((9, 1, 3)))
    assert len(ntsc.resampled(30)) == 9
