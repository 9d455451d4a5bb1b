"""Unknown rigs: joints suggested by the hierarchy, joints that a rig lacks, names that clash."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.motion import (
    JOINTS,
    MotionFileError,
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
from numpy_cae.motion.io.coordinates import TO_Y_UP
from numpy_cae.motion.retarget.completed import completed, without_added
from numpy_cae.motion.retarget.suggest import suggest_mapping

WALK = make_take("walk", 1, 2.0, 30.0).motion


def renamed(motion, names):
    return replace(motion, skeleton=replace(motion.skeleton, names=tuple(names)))


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
        assert find_joints(unknown, mapping) == find_joints(skeleton)


def test_nothing_is_suggested_where_nothing_is_like_a_person():
    chain = Skeleton(("a", "b", "c"), (-1, 0, 1), np.ones((3, 3)))
    star = Skeleton(tuple("abcde"), (-1, 0, 0, 0, 0), np.ones((5, 3)))
    assert suggest_mapping(chain) == suggest_mapping(star) == {}


def without(motion, *dropped):
    """The motion without some joints; a leaf becomes the End Site of its parent."""
    skeleton = motion.skeleton
    gone = {skeleton.index(name) for name in dropped}
    kept = [joint for joint in range(len(skeleton.names)) if joint not in gone]
    parents, translations = [], motion.translations.copy()
    for joint in kept:
        above = skeleton.parents[joint]
        while above in gone:  # these joints do not rotate
            translations[:, joint] += translations[:, above]
            above = skeleton.parents[above]
        parents.append(kept.index(above) if above >= 0 else -1)
    tips = {
        kept.index(skeleton.parents[joint]): skeleton.offsets[joint]
        for joint in gone
        if not skeleton.children(joint)
    }
    offsets = translations[0]
    names = tuple(skeleton.names[joint] for joint in kept)
    small = Skeleton(names, tuple(parents), offsets[kept], tips)
    return replace(
        motion,
        skeleton=small,
        rotations=motion.rotations[:, kept],
        translations=translations[:, kept],
    )


def test_missing_toes_spine_and_collars_are_points_on_the_bones_there_are(tmp_path):
    body = body_positions(WALK)
    whole = fit_motion(body, bone_lengths(body), 30.0)
    still = whole.rotations.copy()
    collars = [JOINTS.index(f"{side}_collar") for side in ("left", "right")]
    still[:, [JOINTS.index("spine"), *collars]] = [0, 0, 0, 1]
    whole = replace(whole, rotations=still)
    file = without(whole, "left_toe", "right_toe", "spine", "left_collar", "right_collar")
    found = completed(file)
    assert found.skeleton.added == 5
    assert found.skeleton.names[-5:] == tuple(
        f"{each} (added)"
        for each in ("spine", "left_collar", "right_collar", "left_toe", "right_toe")
    )
    gap = np.linalg.norm(body_positions(found) - body_positions(whole), axis=-1).max(axis=0)
    at = dict(zip(JOINTS, gap, strict=True))
    assert at["left_toe"] < 1e-9 and at["left_wrist"] < 1e-9 and at["spine"] < 0.1
    assert at["left_collar"] < 0.12
    targets = body_positions(found) + [0.1, 0.0, 0.0]
    write_bvh(retarget(found, targets), tmp_path / "moved.bvh")
    assert read_bvh(tmp_path / "moved.bvh").skeleton.names == file.skeleton.names
    assert without_added(found).skeleton.names == file.skeleton.names
    again = body_positions(load_motion(tmp_path / "moved.bvh", unit=0.01))
    np.testing.assert_allclose(again, targets, atol=2e-3)


def test_two_joints_of_one_name_behind_a_colon_are_refused_with_their_lines(tmp_path):
    path = tmp_path / "two.bvh"
    names = list(WALK.skeleton.names)
    names[5], names[7] = "ann:hand", "bob:hand"
    write_bvh(renamed(WALK, names), path)
    with pytest.raises(MotionFileError, match=r"two\.bvh:\d+: joint name 'bob:hand' .* 'ann:hand'"):
        load_motion(path)
