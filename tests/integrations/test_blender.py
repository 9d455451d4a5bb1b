"""The add-on in Blender itself, without a window: `pip install bpy`, then -m thorough."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

import numpy_cae
from data_synth import make_take
from numpy_cae.motion import Motion

bpy = pytest.importorskip("bpy")
pytestmark = [
    pytest.mark.thorough,
    # Blender's importers leave files open.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]

ADD_ON = Path(__file__).parents[2] / "integrations" / "blender" / "__init__.py"
FORMATS = ["bvh", "fbx", "fbx by the new importer", "glb"]
RATE = 30.0
SPIKE = slice(50, 53)
"""The frames of the motion in which the left forearm is turned."""


@pytest.fixture(scope="module")
def add_on():
    """The add-on, registered. Blender does not end where classes are registered."""
    spec = importlib.util.spec_from_file_location("numpy_cae_in_blender", ADD_ON)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    module.register()
    yield module
    module.unregister()


@pytest.fixture(autouse=True)
def empty_scene(add_on):
    bpy.ops.wm.read_factory_settings(use_empty=True)


def walk(damaged: bool) -> Motion:
    """A walk of four seconds, with a spike of the left forearm if it is to be damaged."""
    motion = make_take("walk", 0, seconds=4.0, rate=RATE).motion
    if damaged:
        motion.rotations[SPIKE, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    return motion


def import_bvh(path, **options):
    """The armature of a BVH file, active."""
    bpy.ops.import_anim.bvh(
        filepath=str(path), update_scene_fps=True, update_scene_duration=True, **options
    )
    return bpy.context.object


def imported_walk(folder, damaged=True, **options):
    path = folder / f"walk_{damaged}.bvh"
    numpy_cae.save(walk(damaged), path)
    return import_bvh(path, **options)


def add_skin(obj):
    """A mesh that the armature moves: without one, glTF has no bones."""
    mesh = bpy.data.meshes.new("skin")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    skin = bpy.data.objects.new("skin", mesh)
    bpy.context.collection.objects.link(skin)
    skin.parent = obj
    for bone in obj.data.bones:
        skin.vertex_groups.new(name=bone.name).add([0, 1, 2], 1.0, "REPLACE")
    skin.modifiers.new("Armature", "ARMATURE").object = obj


def through_file(obj, form, folder):
    """The armature written by Blender to a file of a format, and read from it into an empty
    scene."""
    path = str(folder / f"written.{form[:3]}")
    first, last = obj.animation_data.action.frame_range
    if form == "bvh":
        bpy.ops.export_anim.bvh(
            filepath=path, frame_start=round(first), frame_end=round(last), root_transform_only=True
        )
    elif form.startswith("fbx"):
        bpy.ops.export_scene.fbx(
            filepath=path,
            object_types={"ARMATURE"},
            add_leaf_bones=False,
            bake_anim_simplify_factor=0.0,
        )
    else:
        add_skin(obj)
        bpy.ops.export_scene.gltf(filepath=path, export_optimize_animation_size=False)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if form == "bvh":
        return activate(import_bvh(path, axis_forward="Y", axis_up="Z"))  # as Blender writes it
    if form == "fbx":
        bpy.ops.import_scene.fbx(filepath=path)
    elif form.startswith("fbx"):
        bpy.ops.wm.fbx_import(filepath=path)
    else:
        bpy.ops.import_scene.gltf(filepath=path)
    return activate(next(x for x in bpy.data.objects if x.type == "ARMATURE"))


def activate(obj):
    """The object, active and in pose mode with no bone selected."""
    bpy.context.view_layer.objects.active = obj
    select(obj, [])
    return obj


def select(obj, names):
    """Select some bones and no others."""
    for bone in obj.pose.bones:
        holder = bone if hasattr(bone, "select") else bone.bone
        holder.select = bone.name in names


def shown_heads(obj, times):
    """Where Blender shows each bone to begin, by name, (F, 3) in the world."""
    heads = {bone.name: [] for bone in obj.pose.bones}
    for time in times:
        frame = int(np.floor(time))
        bpy.context.scene.frame_set(frame, subframe=float(time - frame))
        for bone in obj.pose.bones:
            heads[bone.name].append(np.array(obj.matrix_world @ bone.head))
    return {name: np.array(places) for name, places in heads.items()}


def read(add_on, obj):
    action, slot = add_on.require_action(obj)
    return add_on.read_action(bpy.context.scene, obj, add_on.curves_of(action, slot))


def all_keys(add_on, obj):
    """The times and values of the keys of each curve."""
    action, slot = add_on.require_action(obj)
    keys = {}
    for curve in add_on.curves_of(action, slot):
        keys[curve.data_path, curve.array_index] = add_on.key_array(curve, "co", 2)
    return keys


def changed_curves(before, after):
    """The frames of the keys that differ, for each curve of which any does."""
    assert before.keys() <= after.keys()
    changes = {}
    for name, keys in after.items():
        if name not in before:
            changes[name] = keys[:, 0].tolist()
        elif len(keys) != len(before[name]):
            changes[name] = sorted({*keys[:, 0].tolist()} ^ {*before[name][:, 0].tolist()})
        elif (keys != before[name]).any():
            changes[name] = keys[(keys != before[name]).any(axis=1), 0].tolist()
    return changes


@pytest.mark.parametrize("form", FORMATS)
def test_the_motion_is_the_one_that_blender_shows(add_on, tmp_path, form):
    obj = through_file(imported_walk(tmp_path), form, tmp_path)
    reading = read(add_on, obj)
    shown = shown_heads(obj, reading.times)
    motion = reading.motion
    positions = motion.positions() + [0.0, motion.floor, 0.0]
    assert motion.up == "y"
    for index, name in enumerate(reading.armature.names):
        x, y, z = shown[name].T * motion.unit
        expected = np.stack([x, z, -y], axis=1)
        np.testing.assert_allclose(positions[:, index], expected, atol=2e-5)


@pytest.mark.parametrize("form", FORMATS)
def test_the_rate_is_that_of_the_keys(add_on, tmp_path, form):
    reading = read(add_on, through_file(imported_walk(tmp_path), form, tmp_path))
    assert reading.motion.rate == pytest.approx(RATE, rel=1e-3)
    assert len(reading.motion) == 120


@pytest.mark.parametrize("form", FORMATS)
def test_a_spike_is_repaired_and_no_other_frame_changes(add_on, tmp_path, form):
    truth = read(add_on, through_file(imported_walk(tmp_path, False), form, tmp_path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    obj = through_file(imported_walk(tmp_path), form, tmp_path)
    before = read(add_on, obj)
    shown_before = shown_heads(obj, before.times)
    bpy.ops.numpy_cae.find()
    rows = [(row.joint, row.accept) for row in obj.numpy_cae.findings]
    assert rows == [("left_elbow", True)]
    bpy.ops.numpy_cae.apply()
    shown = shown_heads(obj, before.times)
    outside = np.ones(len(before.times), bool)
    outside[SPIKE] = False
    for name, places in shown.items():
        np.testing.assert_allclose(places[outside], shown_before[name][outside], atol=1e-5)
    wrist = [truth.armature.names.index("lwrist")]
    expected = truth.motion.positions(wrist)[SPIKE]
    damaged = np.linalg.norm(before.motion.positions(wrist)[SPIKE] - expected, axis=-1)
    repaired = np.linalg.norm(read(add_on, obj).motion.positions(wrist)[SPIKE] - expected, axis=-1)
    assert damaged.min() > 0.1
    assert repaired.max() < 0.05


@pytest.mark.parametrize("mode", ["NATIVE", "QUATERNION", "XYZ", "YXZ"])
def test_only_keys_of_the_bone_and_the_frames_change(add_on, tmp_path, mode):
    obj = imported_walk(tmp_path, rotate_mode=mode)
    before = all_keys(add_on, obj)
    bpy.ops.numpy_cae.find()
    bpy.ops.numpy_cae.apply()
    changes = changed_curves(before, all_keys(add_on, obj))
    assert {path.split('"')[1] for path, _ in changes} == {"lradius"}
    frames = {frame for keys in changes.values() for frame in keys}
    assert frames == {51.0, 52.0, 53.0}  # Blender's first frame is 1


def test_axis_and_angle_are_written(add_on, tmp_path):
    obj = imported_walk(tmp_path, rotate_mode="QUATERNION")
    bone = obj.pose.bones["lradius"]
    reading = read(add_on, obj)
    index = reading.armature.names.index("lradius")
    bone.rotation_mode = "AXIS_ANGLE"
    turns = reading.poses.rotations[:, index]
    for time, channels in zip(
        reading.times, add_on.write_rotations("AXIS_ANGLE", turns, np.zeros(4)), strict=True
    ):
        bone.rotation_axis_angle = channels
        bone.keyframe_insert("rotation_axis_angle", frame=time)
    bpy.ops.numpy_cae.find()
    bpy.ops.numpy_cae.apply()
    same = np.abs(np.sum(read(add_on, obj).poses.rotations[:, index] * turns, axis=1))
    assert np.flatnonzero(same < 0.999).tolist() == [50, 51, 52]


def test_what_is_not_ticked_stays(add_on, tmp_path):
    obj = imported_walk(tmp_path)
    before = all_keys(add_on, obj)
    bpy.ops.numpy_cae.find()
    bpy.ops.numpy_cae.apply()
    obj.numpy_cae.findings[0].accept = False
    bpy.ops.numpy_cae.apply()
    assert changed_curves(before, all_keys(add_on, obj)) == {}


def test_half_the_strength_goes_half_the_way(add_on, tmp_path):
    obj = imported_walk(tmp_path)
    index = read(add_on, obj).armature.names.index("lradius")
    bpy.ops.numpy_cae.find()
    turns = []
    for strength in (0.0, 1.0, 0.5):
        obj.numpy_cae.strength = strength
        bpy.ops.numpy_cae.apply()
        turns.append(read(add_on, obj).poses.rotations[51, index])
    start, end, middle = turns
    assert abs(start @ end) < 0.9
    mean = start + np.sign(start @ end) * end
    assert abs(mean @ middle) / np.linalg.norm(mean) == pytest.approx(1.0, abs=1e-6)


def test_undo_takes_back_the_keys_and_the_list(add_on, tmp_path):
    obj = imported_walk(tmp_path)
    name = obj.name
    bpy.ops.ed.undo_push(message="imported")
    before = all_keys(add_on, obj)
    bpy.ops.numpy_cae.find()
    bpy.ops.ed.undo_push(message="found")
    bpy.ops.numpy_cae.apply()
    bpy.ops.ed.undo_push(message="applied")
    assert changed_curves(before, all_keys(add_on, bpy.data.objects[name]))
    bpy.ops.ed.undo()
    obj = bpy.data.objects[name]
    assert changed_curves(before, all_keys(add_on, obj)) == {}
    assert len(obj.numpy_cae.findings) == 1
    bpy.ops.ed.undo()
    assert len(bpy.data.objects[name].numpy_cae.findings) == 0


def set_range(first, last):
    scene = bpy.context.scene
    scene.use_preview_range = True
    scene.frame_preview_start = first
    scene.frame_preview_end = last


def test_marked_bones_are_filled_in_the_preview_range(add_on, tmp_path):
    obj = imported_walk(tmp_path, damaged=False)
    before = all_keys(add_on, obj)
    select(obj, ["lwrist"])
    set_range(40, 70)
    bpy.ops.numpy_cae.mark()
    bpy.ops.numpy_cae.apply()
    changes = changed_curves(before, all_keys(add_on, obj))
    frames = {frame for keys in changes.values() for frame in keys}
    assert frames
    assert frames <= set(range(40, 71))
    assert {path.split('"')[1] for path, _ in changes} <= {"lhumerus", "lradius", "lwrist"}


def test_frames_beyond_the_preview_range_are_not_listed(add_on, tmp_path):
    obj = imported_walk(tmp_path)
    set_range(60, 90)
    bpy.ops.numpy_cae.find()
    assert len(obj.numpy_cae.findings) == 0


@pytest.mark.parametrize(("bone", "rows"), [("lradius", 1), ("rradius", 0)])
def test_bones_that_are_not_selected_are_not_listed(add_on, tmp_path, bone, rows):
    obj = imported_walk(tmp_path)
    select(obj, [bone])
    obj.numpy_cae.only_selected = True
    bpy.ops.numpy_cae.find()
    assert len(obj.numpy_cae.findings) == rows


def test_a_row_of_the_list_jumps_to_its_frame_and_bone(add_on, tmp_path):
    obj = imported_walk(tmp_path)
    bpy.ops.numpy_cae.find()
    bpy.context.scene.frame_set(1)
    obj.numpy_cae.active = 0
    assert bpy.context.scene.frame_current == 51
    assert obj.data.bones.active.name == "lradius"


def thinned(add_on, obj, step):
    """Keep every n-th key of all curves, with smooth handles, as an animator sets keys."""
    action, slot = add_on.require_action(obj)
    for curve in add_on.curves_of(action, slot):
        points = curve.keyframe_points
        for index in reversed(range(len(points))):
            if index % step:
                points.remove(points[index], fast=True)
        for point in points:
            point.interpolation = "BEZIER"
            point.handle_left_type = point.handle_right_type = "AUTO_CLAMPED"
        curve.update()


def test_between_sparse_keys_the_curve_stays_outside_of_what_is_filled(add_on, tmp_path):
    obj = imported_walk(tmp_path, damaged=False)
    thinned(add_on, obj, 15)
    times = np.arange(1.0, 106.0)
    before = shown_heads(obj, times)
    keys = all_keys(add_on, obj)
    select(obj, ["lwrist", "lradius"])
    set_range(50, 56)
    bpy.ops.numpy_cae.mark()
    bpy.ops.numpy_cae.apply()
    after = shown_heads(obj, times)
    outside = (times < 50) | (times > 56)
    for name, places in after.items():
        np.testing.assert_allclose(places[outside], before[name][outside], atol=1e-4)
    now = all_keys(add_on, obj)
    assert changed_curves(keys, now)
    for name, old in keys.items():
        kept = old[(old[:, 0] < 50) | (old[:, 0] > 56)]
        assert {*map(tuple, kept.tolist())} <= {*map(tuple, now[name].tolist())}


def test_an_edit_since_the_search_is_not_lost(add_on, tmp_path):
    obj = imported_walk(tmp_path)
    bpy.ops.numpy_cae.find()
    obj.pose.bones["rradius"].keyframe_insert("location", frame=7)
    keys = all_keys(add_on, obj)
    with pytest.raises(RuntimeError, match="changed since the search"):
        bpy.ops.numpy_cae.apply()
    assert changed_curves(keys, all_keys(add_on, obj)) == {}


def test_done_leaves_the_repair_and_removes_the_copy(add_on, tmp_path):
    obj = imported_walk(tmp_path)
    bpy.ops.numpy_cae.find()
    bpy.ops.numpy_cae.apply()
    repaired = all_keys(add_on, obj)
    assert len(bpy.data.actions) == 2
    bpy.ops.numpy_cae.end()
    assert len(bpy.data.actions) == 1
    assert changed_curves(repaired, all_keys(add_on, obj)) == {}


def test_the_list_is_in_the_saved_file(add_on, tmp_path):
    name = imported_walk(tmp_path).name
    bpy.ops.numpy_cae.find()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert len(bpy.data.objects[name].numpy_cae.findings) == 1
    bpy.context.view_layer.objects.active = bpy.data.objects[name]
    bpy.ops.numpy_cae.apply()


def add_constraint(obj):
    obj.pose.bones["lwrist"].constraints.new("COPY_ROTATION").target = obj


def add_scale(obj):
    obj.pose.bones["lwrist"].scale = (1.0, 2.0, 1.0)


def remove_action(obj):
    obj.animation_data.action = None


def add_modifier(obj):
    curve = next(curve for curve in all_curves(obj) if "lradius" in curve.data_path)
    curve.modifiers.new("NOISE")


def all_curves(obj):
    module = sys.modules["numpy_cae_in_blender"]
    return module.curves_of(*module.require_action(obj))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (add_constraint, "lwrist has a constraint.*bake the action"),
        (add_scale, "lwrist is scaled"),
        (remove_action, "has no action"),
        (add_modifier, "lradius is muted or has a modifier"),
    ],
)
def test_a_pose_that_is_not_that_of_the_keys_is_refused(add_on, tmp_path, change, message):
    obj = imported_walk(tmp_path)
    change(obj)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.numpy_cae.find()
