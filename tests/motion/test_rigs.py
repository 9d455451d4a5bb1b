"""The twenty joints in a rig: by its names, a mapping or its hierarchy; joints that a rig lacks."""

import json

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.motion import (
    JOINTS,
    PARENTS,
    Motion,
    Skeleton,
    UnknownRigError,
    body_positions,
    find_joints,
    load_body,
    load_motion,
    read_bvh,
    read_mapping,
    retarget,
    write_bvh,
)
from numpy_cae.motion.axes import TO_Y_UP
from numpy_cae.motion.retarget.completed import completed
from numpy_cae.motion.retarget.fit import body_skeleton
from numpy_cae.motion.retarget.rig_names import RIGS
from numpy_cae.motion.retarget.rigs import joint_index, with_joint_names
from numpy_cae.motion.retarget.suggest import suggest_mapping


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
    "file",
    ["bandai/dataset-2_walk_normal_001.bvh", "cmu/asfamc/02/02_01.amc"]
    + ["cmu/bvh/02_03_first_frames.bvh"],
)
def test_real_rigs_stand_upright_with_their_left_on_the_left(data_folder, file):
    positions, _ = load_body(data_folder / file)
    at = dict(zip(JOINTS, positions.transpose(1, 0, 2), strict=True))
    tall = at["head"][:, 1] - np.minimum(at["left_toe"][:, 1], at["right_toe"][:, 1])
    assert 1.05 < np.median(tall) < 1.9
    # Facing along (across × up), the toes lie before the ankles.
    across = at["left_hip"] - at["right_hip"]
    forward = np.cross(across, [0, 1, 0])
    toes = at["left_toe"] + at["right_toe"] - at["left_ankle"] - at["right_ankle"]
    assert np.median(np.sum(toes * forward, axis=1)) > 0


WALK = make_take("walk", 1, 2.0, 30.0).motion


@pytest.mark.parametrize("axes", ["y", "z", "-x"])
def test_a_rig_of_meaningless_names_is_suggested_by_its_hierarchy(axes, data_folder):
    cmu = load_motion(data_folder / "cmu/asfamc/02/02_01.amc").skeleton
    turn = np.array(TO_Y_UP[axes], dtype=float)
    for skeleton in (WALK.skeleton, cmu):
        offsets = skeleton.offsets @ turn
        tips = {joint: tip @ turn for joint, tip in skeleton.end_sites.items()}
        names = [f"bone {number}" for number in range(len(skeleton.names))]
        unknown = Skeleton(tuple(names), skeleton.parents, offsets, tips)
        mapping = suggest_mapping(unknown)
        truth = [names[joint] for joint in find_joints(skeleton)]
        assert mapping == dict(zip(JOINTS, truth, strict=True))
        assert find_joints(with_joint_names(unknown, mapping)) == find_joints(skeleton)


def test_nothing_is_suggested_where_nothing_is_like_a_person():
    chain = Skeleton(("a", "b", "c"), (-1, 0, 1), np.ones((3, 3)))
    star = Skeleton(tuple("abcde"), (-1, 0, 0, 0, 0), np.ones((5, 3)))
    assert suggest_mapping(chain) == suggest_mapping(star) == {}


def test_missing_toes_spine_and_collars_are_points_on_the_bones_there_are(tmp_path):
    lacking = ("spine", "left_collar", "right_collar", "left_toe", "right_toe")
    names = [joint for joint in JOINTS if joint not in lacking]
    above = {"chest": "hips", "left_shoulder": "chest", "right_shoulder": "chest"}
    parents = [
        names.index(above.get(name, JOINTS[max(0, PARENTS[JOINTS.index(name)])])) for name in names
    ]
    offsets = body_skeleton(np.full(20, 0.3)).offsets[[JOINTS.index(name) for name in names]]
    offsets[[names.index("left_shoulder"), names.index("right_shoulder")], 1] += 0.1
    tips = {names.index(f"{side}_ankle"): np.array([0, -0.05, 0.12]) for side in ("left", "right")}
    turn = np.tile([0.0, 0.0, 0.0, 1.0], (4, len(names), 1))
    skeleton = Skeleton(tuple(names), (-1, *parents[1:]), offsets, tips)
    file = Motion(skeleton, 30.0, turn, np.tile(offsets, (4, 1, 1)), 0.01)
    found = completed(file)
    assert found.skeleton.names[len(names) :] == tuple(f"{joint} (added)" for joint in lacking)
    at = dict(zip(JOINTS, body_positions(found)[0], strict=True))
    np.testing.assert_allclose(at["left_toe"] - at["left_ankle"], [0, -0.05, 0.12], atol=1e-12)
    np.testing.assert_allclose(at["spine"], (at["hips"] + at["chest"]) / 2, atol=1e-12)
    targets = body_positions(found) + [0.1, 0.0, 0.0]
    write_bvh(retarget(found, targets), tmp_path / "moved.bvh")
    assert read_bvh(tmp_path / "moved.bvh").skeleton.names == file.skeleton.names
    again = body_positions(load_motion(tmp_path / "moved.bvh", unit=0.01, up="y", floor=0))
    np.testing.assert_allclose(again, targets, atol=1e-5)
