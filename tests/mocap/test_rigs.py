"""The twenty joints in a rig: by its names, a mapping or its hierarchy; joints that a rig lacks."""

import json
from dataclasses import replace

import numpy as np
import pytest
from acclaim_files import FILES

from data_synth import make_take
from numpy_cae.mocap import load_motion, retarget, write_bvh
from numpy_cae.mocap.retargeting.body import body_positions
from numpy_cae.mocap.rigs.recognise import (
    add_missing_joints,
    find_doubt,
    find_joints,
    joint_index,
    recognise_rig,
    rig_of,
)
from numpy_cae.mocap.rigs.rigs import RIGS, UnknownRigError, attach_rig, read_mapping, rig_by_names
from numpy_cae.motion import JOINTS, PARENTS, Motion, Skeleton
from numpy_cae.motion.features import bone_lengths
from numpy_cae.motion.fit import body_skeleton


def skeleton_of(names):
    """A person whose joints have these names, in the order of `JOINTS`."""
    return person(dict(zip(JOINTS, names, strict=True)).get).skeleton


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


FOUND = json.loads((FILES / "rigs.json").read_text(encoding="utf-8"))
"""Rigs of public files, without fingers and faces: names, parents and the twenty joints, "-" for
one that is missing."""


@pytest.mark.parametrize("rig", FOUND.values(), ids=FOUND)
def test_rigs_of_other_programs_are_found_by_their_names(rig):
    names = rig["names"].split()
    skeleton = Skeleton(tuple(names), tuple(rig["parents"]), np.ones((len(names), 3)))
    indices = rig_by_names(skeleton).indices
    assert [names[indices[j]] if j in indices else "-" for j in JOINTS] == rig["twenty"].split()


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
    motion = person(dict(zip(JOINTS, names, strict=True)).get)
    for mapping in (read_mapping(file), [{"left_wrist": "claw"}, read_mapping(file)]):
        joints = rig_of(recognise_rig(motion, mapping)).joints
        assert motion.skeleton.names[joints[JOINTS.index("left_wrist")]] == "paw"
    with pytest.raises(UnknownRigError, match=r"left_wrist \(as 'claw'\)"):
        rig_of(recognise_rig(motion, {"left_wrist": "claw"}))
    skeleton = skeleton_of(names_in("Mixamo"))
    assert rig_by_names(skeleton, [{"head": "x"}, {"head": "y"}]).joints == find_joints(skeleton)


def test_a_joint_is_named_as_ours_or_as_the_rigs():
    names = dict(zip(JOINTS, names_in("Mixamo"), strict=True))
    motion = person(lambda joint: f"mixamorig:{names[joint]}")
    named = {
        "left_shoulder": "left_shoulder",
        "LeftShoulder": "left_collar",  # the rig's own, which is not ours of nearly that name
        "mixamorig:LeftLeg": "left_knee",
        "rightleg": "right_knee",
    }
    for name, joint in named.items():
        assert JOINTS[joint_index(name, motion)] == joint
    with pytest.raises(UnknownRigError, match=r"no joint 'tail'.*left_knee \(mixamorig:LeftLeg\)"):
        joint_index("tail", motion)


@pytest.mark.parametrize(
    "text",
    ["{", "[1]", '{"hips": 3}', '{"tail": "x"}', '{"spine": "a", "chest": "a"}']
    + ['{"hips":' + "[" * 100_000],
)
def test_an_invalid_mapping_is_refused_with_its_file(tmp_path, text):
    file = tmp_path / "rig.json"
    file.write_text(text)
    words = r"rig\.json: (not JSON|expected an obj|not among|a stands)"
    with pytest.raises(UnknownRigError, match=words):
        read_mapping(file)


@pytest.mark.parametrize("file", ["asfamc/02/02_01.amc", "bvh/02_03_first_frames.bvh"])
def test_the_joints_of_real_rigs_are_beyond_doubt(data_folder, file):
    motion = load_motion(data_folder / "cmu" / file)
    unnamed = replace(motion.skeleton, names=tuple(map(str, range(len(motion.skeleton.names)))))
    joints = rig_of(motion).joints
    assert find_doubt(replace(motion, skeleton=unnamed)) == ""
    assert rig_of(recognise_rig(replace(motion, skeleton=unnamed))).joints == joints


WALK = make_take("walk", 1, 2.0, 30.0).motion


LENGTHS = bone_lengths(body_positions(WALK))
TOES, COLLARS = ["left_toe", "right_toe"], ["left_collar", "right_collar"]


def person(name, lacking=(), lengths=LENGTHS):
    """Someone in a T-pose whose rig lacks some of the twenty joints and End Sites; `name` maps a
    joint to its name in the rig."""
    present = [joint for joint in range(20) if JOINTS[joint] not in lacking]
    nearest = [joint if joint in present else PARENTS[joint] for joint in range(20)] + [-1]
    parents = [nearest[PARENTS[joint]] for joint in present]
    places = body_skeleton(lengths).rest_positions()
    offsets = places[present] - places[np.maximum(parents, 0)]
    parents = [-1 if parent < 0 else present.index(parent) for parent in parents]
    skeleton = Skeleton(tuple(name(JOINTS[joint]) for joint in present), tuple(parents), offsets)
    still = np.tile([0.0, 0.0, 0.0, 1.0], (4, len(present), 1))
    return Motion(skeleton, 30.0, still, np.tile(offsets, (4, 1, 1)), 0.01)


def bone(joint):
    return f"bone {JOINTS.index(joint)}"


def swapped(joint):
    """Names of a common rig in the wrong order, which are not believed."""
    return {"left_shoulder": "left_elbow", "left_elbow": "left_shoulder"}.get(joint, joint)


def test_rig_writes_the_suggestion_where_known_names_leave_fewer_joints(run, tmp_path):
    """left_toe is the ankle of this rig. Its trunk is short, so nothing is taken for granted."""
    short = LENGTHS * np.where(np.isin(JOINTS, ["spine", "chest"]), 0.2, 1.0)
    motion = person(lambda joint: joint.replace("toe", "tip").replace("ankle", "toe"), (), short)
    take, mapping = tmp_path / "take.bvh", tmp_path / "rig.json"
    write_bvh(motion, take)
    assert len(load_motion(take).rig.indices) < len(JOINTS)
    run("rig", take, "-o", mapping)
    rig_of(load_motion(take, mapping=read_mapping(mapping)))
    assert read_mapping(mapping)["left_ankle"] == "left_toe"


def test_missing_toes_spine_and_collars_are_points_on_the_bones_there_are(tmp_path):
    lacking = ("spine", *COLLARS, *TOES)
    names = (file := person(str, lacking)).skeleton.names
    file.skeleton.offsets[names.index("left_shoulder"), 1] += 0.1  # the chest's bones differ
    for side in ("left", "right"):
        file.skeleton.end_sites[names.index(f"{side}_ankle")] = np.array([0, -0.05, 0.12])
    completed = add_missing_joints(attach_rig(file, rig_by_names(file.skeleton)))
    assert set(completed.skeleton.names[len(names) :]) == {f"{joint} (added)" for joint in lacking}
    at = dict(zip(JOINTS, body_positions(completed)[0], strict=True))
    np.testing.assert_allclose(at["left_toe"] - at["left_ankle"], [0, -0.05, 0.12], atol=1e-12)
    np.testing.assert_allclose(at["spine"], (at["hips"] + at["chest"]) / 2, atol=1e-12)
    targets = body_positions(completed) + [0.1, 0.0, 0.0]
    write_bvh(retarget(completed, targets), tmp_path / "moved.bvh")
    again = body_positions(load_motion(tmp_path / "moved.bvh", unit=0.01, up="y", floor=0))
    np.testing.assert_allclose(again, targets, atol=1e-5)


def test_a_spine_at_the_hips_is_added_half_way_to_the_chest(tmp_path):
    """Some rigs turn the trunk by a joint that is at the place of the hips."""
    file = person(str)
    spine = file.skeleton.names.index("spine")
    file.skeleton.offsets[spine] = 0.0
    placed = replace(file, translations=np.tile(file.skeleton.offsets, (len(file), 1, 1)))
    completed = add_missing_joints(attach_rig(placed, rig_by_names(file.skeleton)))
    assert completed.skeleton.names[-1] == "spine (added)"
    assert completed.skeleton.parents[-1] == spine
    at = dict(zip(JOINTS, body_positions(completed)[0], strict=True))
    np.testing.assert_allclose(at["spine"], (at["hips"] + at["chest"]) / 2, atol=1e-12)
    assert np.linalg.norm(at["chest"] - at["hips"]) > 0.05
    targets = body_positions(completed) + [0.1, 0.0, 0.0]
    write_bvh(retarget(completed, targets), tmp_path / "moved.bvh")
    again = body_positions(load_motion(tmp_path / "moved.bvh", unit=0.01, up="y", floor=0))
    np.testing.assert_allclose(again, targets, atol=1e-5)


INCOMPLETE = [(str, ["head", *TOES]), (str, TOES), (bone, ["spine", *COLLARS]), (swapped, [])]
DOUBTS = [(TOES, 1, "neither names nor toes tell"), ([], 2, "the ratio of thigh to shin is 2")]


@pytest.mark.parametrize(("name", "lacking"), INCOMPLETE)
def test_an_incomplete_rig_is_recognised_and_its_ends_are_added(name, lacking):
    recognised = recognise_rig(person(name, lacking))
    names = [recognised.skeleton.names[joint] for joint in rig_of(recognised).joints]
    assert [
        JOINTS[rig_of(recognised).joints.index(joint)] for joint in recognised.rig.added
    ] == lacking
    assert names == [f"{j} (added)" if j in lacking else name(j) for j in JOINTS]
    assert "`numpy-cae rig` lists the joints" in recognised.note
    np.testing.assert_allclose(
        body_positions(recognised)[0], body_positions(person(str))[0], atol=0.2
    )


@pytest.mark.parametrize(("lacking", "scale", "problem"), DOUBTS)
def test_a_doubtful_suggestion_is_not_used_but_shown(lacking, scale, problem):
    lengths = LENGTHS * np.where([joint.endswith("knee") for joint in JOINTS], scale, 1)
    recognised = recognise_rig(person(bone, lacking, lengths=lengths))
    assert f"rig not recognised: {problem}" in recognised.note
    with pytest.raises(UnknownRigError, match=r'hierarchy suggests \{"hips": "bone 0"'):
        rig_of(recognised)


def test_a_doubtful_rig_without_shoulders_is_read(tmp_path):
    names = dict(zip(JOINTS, names_in("Bandai"), strict=True))
    write_bvh(person(lambda x: names[x].replace("Upper", ""), (), LENGTHS**3), tmp_path / "a.bvh")
    assert "not recognised" in load_motion(tmp_path / "a.bvh").note


def test_an_animal_with_a_persons_names_is_doubted():
    dog = person(str)
    legs = [n for n, joint in enumerate(JOINTS) if joint.endswith(("knee", "ankle", "toe"))]
    dog.skeleton.offsets[legs] = dog.skeleton.offsets[legs][:, [0, 2, 1]]  # square to the trunk
    dog = replace(dog, translations=np.tile(dog.skeleton.offsets, (4, 1, 1)))
    assert "is this a person? neither the rest pose nor most" in recognise_rig(dog).note


def test_an_animal_with_a_joint_at_its_hips_is_refused():
    dog = person(str)
    legs = [n for n, joint in enumerate(JOINTS) if joint.endswith(("knee", "ankle", "toe"))]
    dog.skeleton.offsets[legs] = dog.skeleton.offsets[legs][:, [0, 2, 1]]  # square to the trunk
    spine = JOINTS.index("spine")
    dog.skeleton.offsets[spine + 1] += dog.skeleton.offsets[spine]
    dog.skeleton.offsets[spine] = 0.0
    dog = replace(dog, translations=np.tile(dog.skeleton.offsets, (4, 1, 1)))
    recognised = recognise_rig(dog)
    assert "rig not recognised: neither the rest pose nor most" in recognised.note
    with pytest.raises(UnknownRigError):
        rig_of(recognised)
