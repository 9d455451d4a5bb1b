"""Poses of an armature as a motion and back, without Blender."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from data_synth import make_take
from numpy_cae.mocap.armatures import (
    Armature,
    Poses,
    choose_keys,
    choose_times,
    find_changes,
    read_rotations,
    to_motion,
    to_poses,
    write_rotations,
)
from numpy_cae.mocap.rigs.recognise import rig_of

MODES = ["QUATERNION", "AXIS_ANGLE", "XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"]
Y_UP_TO_Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def matrices_of(rotations, translations):
    """(…, 4, 4) from quaternions (…, 4) and vectors (…, 3)."""
    flat = Rotation.from_quat(rotations.reshape(-1, 4)).as_matrix()
    matrices = np.tile(np.eye(4), (*rotations.shape[:-1], 1, 1))
    matrices[..., :3, :3] = flat.reshape(*rotations.shape[:-1], 3, 3)
    matrices[..., :3, 3] = translations
    return matrices


def drawn_armature(scale=0.01, seed=0):
    """A person of `make_take` whose bones have axes of their own, in centimetres, on an object that
    is turned and scaled."""
    rng = np.random.default_rng(seed)
    skeleton = make_take("walk", 0, seconds=1.0, rate=30.0).motion.skeleton
    heads = skeleton.rest_positions() @ Y_UP_TO_Z_UP.T
    rest = np.tile(np.eye(4), (len(heads), 1, 1))
    rest[:, :3, :3] = scale * Rotation.random(len(heads), random_state=rng).as_matrix()
    rest[:, :3, 3] = heads
    return Armature(skeleton.names, skeleton.parents, rest, heads + [0.0, 0.0, 0.05])


def drawn_poses(armature, frames=40, seed=0, moving=False):
    """Small turns of all bones, a root that moves, and an object that moves if it is to."""
    rng = np.random.default_rng(seed)
    joints = len(armature.names)
    turns = Rotation.from_rotvec(rng.normal(scale=0.2, size=(frames * joints, 3)))
    locations = np.zeros((frames, joints, 3))
    locations[:, 0] = rng.normal(size=(frames, 3))
    places = np.tile(np.eye(4), (frames, 1, 1))
    if moving:
        turn = Rotation.from_rotvec(np.linspace(0, 1, frames)[:, None] * [0.0, 0.0, 1.0])
        places[:, :3, :3] = turn.as_matrix()
        places[:, 0, 3] = np.linspace(0, 2, frames)
    return Poses(turns.as_quat().reshape(frames, joints, 4), locations, places)


def world_heads(armature, poses):
    """Where each bone begins, (F, J, 3) in the world with Z up, as Blender computes it."""
    local = matrices_of(poses.rotations, poses.locations)
    bones = np.empty_like(local)
    for bone, parent in enumerate(armature.parents):
        if parent < 0:
            bones[:, bone] = poses.places @ armature.rest[bone] @ local[:, bone]
        else:
            step = np.linalg.inv(armature.rest[parent]) @ armature.rest[bone]
            bones[:, bone] = bones[:, parent] @ step @ local[:, bone]
    return bones[..., :3, 3]


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("scale", [1.0, 0.01])
def test_the_joints_of_the_motion_are_where_the_bones_are(scale, moving):
    armature = drawn_armature(scale)
    poses = drawn_poses(armature, moving=moving)
    motion = to_motion(armature, poses, 30.0)
    assert motion.up == "y"
    heads = motion.unit * world_heads(armature, poses) @ Y_UP_TO_Z_UP
    heads[..., 1] -= motion.floor
    positions = motion.positions()[:, : len(armature.names)]
    np.testing.assert_allclose(positions, heads, atol=1e-9)


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("scale", [1.0, 0.01])
def test_the_way_back_has_the_same_poses(scale, moving):
    armature = drawn_armature(scale)
    poses = drawn_poses(armature, moving=moving)
    back = to_poses(armature, to_motion(armature, poses, 30.0), poses.places)
    same = np.abs(np.sum(back.rotations * poses.rotations, axis=-1))
    np.testing.assert_allclose(same, 1.0, atol=1e-12)
    np.testing.assert_allclose(back.locations, poses.locations, atol=1e-7)


def test_the_rest_pose_turns_no_joint():
    armature = drawn_armature()
    poses = drawn_poses(armature, frames=3)
    poses.rotations[...] = [0.0, 0.0, 0.0, 1.0]
    rotations = to_motion(armature, poses, 30.0).rotations
    np.testing.assert_allclose(np.abs(rotations[..., 3]), 1.0, atol=1e-12)


def test_an_armature_in_centimetres_is_recognised_as_a_person():
    armature = drawn_armature()
    big = Armature(armature.names, armature.parents, armature.rest.copy(), 100 * armature.tails)
    big.rest[:, :3, 3] *= 100
    motion = to_motion(big, drawn_poses(big), 30.0)
    assert motion.unit == 0.01
    assert len(rig_of(motion).joints) == 20


def test_a_bone_of_another_scale_is_refused():
    armature = drawn_armature()
    rest = armature.rest.copy()
    rest[5, :3, 0] *= 1.1
    with pytest.raises(ValueError, match=r"'\w+' is scaled differently along its axes"):
        Armature(armature.names, armature.parents, rest, armature.tails)


def test_an_object_that_changes_its_size_is_refused():
    armature = drawn_armature()
    poses = drawn_poses(armature)
    poses.places[7, :3, :3] *= 1.5
    with pytest.raises(ValueError, match="changes its size"):
        to_motion(armature, poses, 30.0)


@pytest.mark.parametrize("mode", MODES)
def test_rotation_channels_are_read_as_they_were_written(mode):
    turns = Rotation.random(50, random_state=1).as_quat()
    width = 4 if mode in ("QUATERNION", "AXIS_ANGLE") else 3
    channels = write_rotations(mode, turns, np.zeros(width))
    same = np.abs(np.sum(read_rotations(mode, channels) * turns, axis=1))
    np.testing.assert_allclose(same, 1.0, atol=1e-12)


@pytest.mark.parametrize("mode", MODES[2:])
def test_euler_angles_turn_about_fixed_axes_in_the_order_of_their_name(mode):
    angles = np.random.default_rng(0).uniform(-3, 3, (20, 3))
    in_order = angles[:, ["XYZ".index(axis) for axis in mode]]
    expected = Rotation.from_euler(mode.lower(), in_order).as_quat()
    same = np.abs(np.sum(read_rotations(mode, angles) * expected, axis=1))
    np.testing.assert_allclose(same, 1.0, atol=1e-12)


@pytest.mark.parametrize("mode", ["QUATERNION", "ZXY"])
def test_written_channels_do_not_jump(mode):
    turn = Rotation.from_rotvec(np.linspace(0, 12, 200)[:, None] * [0.6, 0.64, 0.48]).as_quat()
    turn[::7] *= -1
    before = np.array([1.0, 0.0, 0.0, 0.0]) if mode == "QUATERNION" else np.zeros(3)
    channels = write_rotations(mode, turn, before)
    # A step of this turn is 0.06; angles near a pole move faster, a jump is 2 (quaternions) or π.
    assert np.abs(np.diff(channels, axis=0)).max() < 1.0


def test_a_quaternion_of_length_0_is_no_rotation():
    np.testing.assert_array_equal(read_rotations("QUATERNION", np.zeros((1, 4))), [[0, 0, 0, 1]])


@pytest.mark.parametrize(
    ("keys", "rate", "times"),
    [
        ([3, 1, 2, 2], 30.0, [1, 2, 3]),
        ([0, 0.8, 1.6, 2.4], 24.0, [0, 0.8, 1.6, 2.4]),  # 30 a second in a scene of 24
        ([0, 10, 20], 24.0, range(21)),  # poses of an animator
        ([0, 1, 2.5], 24.0, [0, 1, 2, 3]),
        ([7], 24.0, [7]),
    ],
)
def test_times_are_those_of_recorded_keys_or_all_frames(keys, rate, times):
    np.testing.assert_allclose(choose_times(keys, rate), list(times))


@pytest.mark.parametrize(
    ("keys", "chosen"),
    [
        (range(10), [4, 5]),
        ([0, 9], range(1, 9)),
        ([4, 5], [3, 4, 5, 6]),
        ([0, 3, 9], range(4, 9)),
    ],
)
def test_only_what_changes_is_keyed_and_what_would_bend_beside_it(keys, chosen):
    times = np.arange(10.0)
    changed = np.isin(times, [4, 5])
    assert np.flatnonzero(choose_keys(np.array(keys, float), times, changed)).tolist() == [*chosen]


def test_changes_are_found_by_joint_and_frame():
    before = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    after = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    after.rotations[3, 5] = [0.6, 0.0, 0.0, 0.8]
    after.translations[4, 0] += 1.0
    rotations, translations = find_changes(before, after)
    assert np.argwhere(rotations).tolist() == [[3, 5]]
    assert np.argwhere(translations).tolist() == [[4, 0]]
