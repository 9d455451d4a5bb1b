"""The twenty joints are found in every known rig and by mapping in others; resampling."""

import json

import numpy as np
import pytest

from numpy_cae.motion import (
    JOINTS,
    PARENTS,
    Motion,
    Skeleton,
    UnknownRigError,
    bone_lengths,
    find_joints,
    joint_index,
    load_body,
    read_mapping,
)
from numpy_cae.motion.retarget.fit import body_skeleton
from numpy_cae.motion.retarget.rig_names import RIGS
from numpy_cae.motion.retarget.rigs import with_joint_names


def skeleton_of(names):
    """A person whose joints have these names, in the order of `JOINTS`, below a joint "world"."""
    rest = body_skeleton(np.full(20, 0.3))
    parents = (-1, *(parent + 1 for parent in PARENTS))
    return Skeleton(("world", *names), parents, np.concatenate([np.zeros((1, 3)), rest.offsets]))


def names_in(rig, which=0):
    """The names of the twenty joints in a rig; a rig may leave its spine's open."""
    return [RIGS[rig].get(joint, (f"{joint} bone",))[which] for joint in JOINTS]


@pytest.mark.parametrize("which", [0, -1])
@pytest.mark.parametrize("dress", [str, str.upper, lambda name: f"ann:{name.replace('_', ' ')}"])
@pytest.mark.parametrize("rig", RIGS)
def test_each_rig_is_found(rig, dress, which):
    names = [dress(name) for name in names_in(rig, which)]
    skeleton = skeleton_of(names)
    assert [skeleton.names[index] for index in find_joints(skeleton)] == names


def test_a_missing_joint_lists_what_the_rig_has_and_what_its_hierarchy_suggests():
    names = [name if name != "Hand_L" else "paw" for name in names_in("Bandai")]
    with pytest.raises(UnknownRigError) as error:
        find_joints(skeleton_of(names))
    assert "no left_wrist (as 'Hand_L')" in str(error.value)
    assert '"left_wrist": "paw"' in str(error.value) and "UpperArm_R" in str(error.value)


def test_of_several_mappings_the_one_that_fits_goes_before_the_table(tmp_path):
    names = [name if name != "Hand_L" else "paw" for name in names_in("Bandai")]
    file = tmp_path / "rig.json"
    file.write_text(json.dumps({"left_wrist": "paw"}))
    skeleton = skeleton_of(names)
    for mapping in (read_mapping(file), [{"left_wrist": "claw"}, read_mapping(file)]):
        found = find_joints(with_joint_names(skeleton, mapping))
        assert skeleton.names[found[JOINTS.index("left_wrist")]] == "paw"
    with pytest.raises(UnknownRigError, match=r"left_wrist \(as 'claw'\)"):
        find_joints(with_joint_names(skeleton, {"left_wrist": "claw"}))
    known = skeleton_of(names_in("Mixamo"))
    assert find_joints(with_joint_names(known, [{"head": "x"}, {"head": "y"}])) == find_joints(
        known
    )


def test_a_joint_is_named_as_ours_or_as_the_rigs():
    skeleton = skeleton_of([f"mixamorig:{name}" for name in names_in("Mixamo")])
    named = {
        "left_shoulder": "left_shoulder",
        "LeftShoulder": "left_collar",  # the rig's own, which is not ours of nearly that name
        "mixamorig:LeftLeg": "left_knee",
        "rightleg": "right_knee",
    }
    for name, joint in named.items():
        assert JOINTS[joint_index(name, skeleton)] == joint
    with pytest.raises(UnknownRigError, match=r"no joint 'tail'.*left_knee \(mixamorig:LeftLeg\)"):
        joint_index("tail", skeleton)


@pytest.mark.parametrize(
    "text",
    ["{", "[1]", '{"hips": 3}', '{"tail": "x"}', '{"spine": "a", "chest": "a"}']
    + ['{"hips":' + "[" * 100_000],
)
def test_an_invalid_mapping_is_refused_with_its_file(tmp_path, text):
    file = tmp_path / "rig.json"
    file.write_text(text)
    with pytest.raises(
        UnknownRigError, match=r"rig\.json: (not JSON|expected an obj|not among|a stands)"
    ):
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


def chain_of(*names):
    parents = tuple(index - 1 for index in range(len(names)))
    return Skeleton(names, parents, np.zeros((len(names), 3)))


def test_resampling_sub_samples_and_interpolates():
    skeleton = chain_of("a", "b")
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
    skeleton = chain_of("a")
    turn = np.tile([0.0, 0, 0, 1], (9, 1, 1))
    motion = Motion(skeleton, 1 / 0.0083333, turn, np.zeros((9, 1, 3)))
    assert len(motion.resampled(30)) == 3
    ntsc = Motion(skeleton, 29.97, turn, np.zeros((9, 1, 3)))
    assert len(ntsc.resampled(30)) == 9
