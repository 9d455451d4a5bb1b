"""Unknown rigs: joints suggested by the hierarchy, joints that a rig lacks."""

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.motion import (
    JOINTS,
    Motion,
    Skeleton,
    body_positions,
    bone_lengths,
    find_joints,
    fit_motion,
    load_motion,
    read_bvh,
    retarget,
    write_bvh,
)
from numpy_cae.motion.axes import TO_Y_UP
from numpy_cae.motion.retarget.completed import completed
from numpy_cae.motion.retarget.rigs import with_joint_names
from numpy_cae.motion.retarget.suggest import suggest_mapping

WALK = make_take("walk", 1, 2.0, 30.0).motion


@pytest.mark.parametrize("axes", ["y", "z", "-x"])
def test_a_rig_of_meaningless_names_is_suggested_by_its_hierarchy(axes, data_folder):
    cmu = load_motion(data_folder / "cmu/asfamc/02/02_01.amc").skeleton
    for skeleton in (WALK.skeleton, cmu):
        offsets = skeleton.offsets @ np.array(TO_Y_UP[axes], dtype=float)
        tips = {
            joint: tip @ np.array(TO_Y_UP[axes], dtype=float)
            for joint, tip in skeleton.end_sites.items()
        }
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
    body = body_positions(WALK)
    whole = fit_motion(body, bone_lengths(body), 30.0).skeleton
    places = whole.rest_positions()
    lacking = ("spine", "left_collar", "right_collar", "left_toe", "right_toe")
    names = [joint for joint in JOINTS if joint not in lacking]
    above = {joint: [JOINTS[each] for each in whole.path(JOINTS.index(joint))] for joint in JOINTS}
    parents = [
        next((names.index(each) for each in above[name][1:] if each in names), -1) for name in names
    ]
    kept = np.array([places[JOINTS.index(name)] for name in names])
    offsets = kept - [kept[parent] if parent >= 0 else np.zeros(3) for parent in parents]
    tips = {names.index(f"{side}_ankle"): np.array([0, -0.05, 0.12]) for side in ("left", "right")}
    turn = np.tile([0.0, 0.0, 0.0, 1.0], (4, len(names), 1))
    skeleton = Skeleton(tuple(names), tuple(parents), offsets, tips)
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
