"""Repair and fill the motion of an armature in Blender: sidebar of the 3D viewport, tab numpy_cae.

*Find Damage* reads the action of the active armature and lists what `numpy_cae.repair` finds;
*Mark* adds bones and frames to be filled in. *Apply* writes what is ticked into the action, as keys
of the bones and frames that change. It always starts from the action as it was, of which a copy is
kept until *Done*. The list, the copy and what is ticked are data of the object, so that undo and
saved files have them.

How an action becomes a motion is in `numpy_cae.mocap.armatures`; here is what needs Blender.
"""

import hashlib
import json
from dataclasses import replace
from functools import partial
from typing import ClassVar, NamedTuple

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)
from mathutils import Matrix, Quaternion

from numpy_cae.cleanup import Finding, repair_motion
from numpy_cae.cleanup.finding import KEPT_REASON, LEFT_REASON
from numpy_cae.cleanup.kinds import BODY, MARKED, T_POSE
from numpy_cae.cleanup.mask_file import require_movable
from numpy_cae.cleanup.result import weaken
from numpy_cae.cleanup.words import count, cuts_in_words
from numpy_cae.manifold import starter
from numpy_cae.mocap.armatures import (
    AXIS_ANGLE,
    LEAST_DIFFERENCE,
    QUATERNION,
    Armature,
    Poses,
    choose_keys,
    choose_times,
    find_changes,
    find_frames,
    order_bones,
    read_rotations,
    to_motion,
    to_poses,
    write_rotations,
)
from numpy_cae.mocap.rigs.recognise import joint_index, rig_of
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.masks import runs

COPY_SUFFIX = " before repair"
"""What the name of the copy of an action ends with."""
ROTATIONS = {QUATERNION: ("rotation_quaternion", 4), AXIS_ANGLE: ("rotation_axis_angle", 4)}
"""The property with the rotation of a bone or an object, and its number of channels, by the
rotation mode; `EULER` for all others."""
EULER = ("rotation_euler", 3)
STATUS_WORDS = {
    "repaired": "",
    "proposed": "proposed: not certain enough",
    "left": f"left: {LEFT_REASON}",
    "kept": f"kept: {KEPT_REASON}",
}
"""Why a finding is not ticked, by its status."""


class Reading(NamedTuple):
    """What an action has of a motion.

    Parameters
    ----------
    armature : Armature
    poses : Poses
    motion : Motion
    times : (F,) array of float64
        The time of each frame of the motion, in frames of the scene.
    channels : list of (F, 4) or (F, 3) arrays
        For each bone its rotation channels.
    """

    armature: Armature
    poses: Poses
    motion: Motion
    times: np.ndarray
    channels: list[np.ndarray]


def require_action(obj):
    """The action of an object and its slot; ValueError if there is none that can be changed."""
    data = obj.animation_data
    if data is None or data.action is None:
        raise ValueError(f"{obj.name} has no action; choose one in the Action editor")
    action = data.action
    if action.library is not None:
        raise ValueError(f"the action {action.name} is linked from another file")
    if data.action_slot is None:
        raise ValueError(f"the action {action.name} has no slot for {obj.name}; choose one")
    return action, data.action_slot


def curves_of(action, slot):
    """The curves of an action for one of its slots."""
    for layer in action.layers:
        for strip in layer.strips:
            if strip.channelbag(slot):
                return strip.channelbag(slot).fcurves
    raise ValueError(f"the action {action.name} has no keys for this armature")


def curves_of_copy(settings, slot):
    """The curves of the copy that was made of an action, which has the same slots."""
    copied = settings.original
    return curves_of(copied, copied.slots[slot.identifier])


def key_array(curve, name, width=1):
    """A property of all keys of a curve, (K,) or (K, width)."""
    values = np.empty(len(curve.keyframe_points) * width, np.float32)
    curve.keyframe_points.foreach_get(name, values)
    return values.reshape(-1, width) if width > 1 else values


def evaluate_curve(curve, times):
    """The values of a curve at some times, in frames."""
    keys = key_array(curve, "co", 2).astype(np.float64)
    if len(keys) == len(times) and np.abs(keys[:, 0] - times).max() <= LEAST_DIFFERENCE:
        return keys[:, 1]
    return np.array([curve.evaluate(time) for time in times])


def evaluate_channels(curves, path, now, times):
    """The channels of a property, (F, N); those without a curve have their value of `now` (N,)."""
    channels = np.tile(np.array(now, dtype=np.float64), (len(times), 1))
    for index in range(len(now)):
        curve = curves.get((path, index))
        if curve is not None:
            channels[:, index] = evaluate_curve(curve, times)
    return channels


def path_of(bone, name):
    """The path of a property of a bone, as curves have it."""
    return f'pose.bones["{bpy.utils.escape_identifier(bone.name)}"].{name}'


def rotation_of(obj):
    """The property with the rotation of a bone or an object, and its number of channels."""
    return ROTATIONS.get(obj.rotation_mode, EULER)


def require_plain(obj, bones, curves):
    """Raise ValueError if the pose of some bones is not that of their keys alone."""
    advice = "bake the action first (Pose, Animation, Bake Action)"
    drivers = [driver.data_path for driver in obj.animation_data.drivers]
    for bone in bones:
        for constraint in bone.constraints:
            if not constraint.mute and constraint.influence > 0:
                raise ValueError(f"{bone.name} has a constraint, {constraint.name}; {advice}")
        if any(path.startswith(path_of(bone, "")) for path in drivers):
            raise ValueError(f"{bone.name} has a driver; {advice}")
        if bone.parent and not bone.bone.use_inherit_rotation:
            raise ValueError(f"{bone.name} does not inherit the rotation of its parent; {advice}")
        sizes = [*bone.scale]
        for name in ("location", "scale", rotation_of(bone)[0]):
            for index in range(4):
                curve = curves.get((path_of(bone, name), index))
                if curve is None:
                    continue
                if curve.mute or any(not modifier.mute for modifier in curve.modifiers):
                    raise ValueError(f"a curve of {bone.name} is muted or has a modifier; {advice}")
                if name == "scale":
                    sizes[index] = 1.0
                    sizes += key_array(curve, "co", 2)[:, 1].tolist()
                if name == "location" and not bone.bone.use_local_location:
                    raise ValueError(f"{bone.name} has no local location; {advice}")
        if np.abs(np.array(sizes) - 1).max() > LEAST_DIFFERENCE:
            raise ValueError(f"{bone.name} is scaled; remove its scale (Alt S) and the keys of it")


def read_places(obj, curves, times):
    """The matrix of the world of an object at some times, (F, 4, 4). A parent is taken to stand
    still."""
    name, width = rotation_of(obj)
    if not any((path, 0) in curves for path in ("location", "scale", name)):
        return np.tile(np.array(obj.matrix_world), (len(times), 1, 1))
    of_parent = np.array(obj.matrix_world @ obj.matrix_basis.inverted())
    locations = evaluate_channels(curves, "location", obj.location, times)
    scales = evaluate_channels(curves, "scale", obj.scale, times)
    now = getattr(obj, name)[:width]
    turns = read_rotations(obj.rotation_mode, evaluate_channels(curves, name, now, times))
    places = []
    for location, turn, scale in zip(locations, turns, scales, strict=True):
        matrix = Matrix.LocRotScale(location, quaternion_of(turn), scale)
        places.append(of_parent @ np.array(matrix))
    return np.array(places)


def quaternion_of(turn):
    """Blender's quaternion of one (x, y, z, w)."""
    x, y, z, w = turn
    return Quaternion((w, x, y, z))


def read_action(scene, obj, all_curves):
    """The motion of an armature by the curves of its action."""
    curves = {(curve.data_path, curve.array_index): curve for curve in all_curves}
    parents = {bone.name: bone.parent and bone.parent.name for bone in obj.data.bones}
    names = order_bones(parents)
    bones = [obj.pose.bones[name] for name in names]
    require_plain(obj, bones, curves)
    keys = []
    for bone in bones:
        for name in ("location", rotation_of(bone)[0]):
            for index in range(4):
                if (path_of(bone, name), index) in curves:
                    keys += key_array(curves[path_of(bone, name), index], "co", 2)[:, 0].tolist()
    rate = scene.render.fps / scene.render.fps_base
    times = choose_times(keys, rate)
    if len(times) < 2:
        raise ValueError("the bones have keys in fewer than two frames")
    channels = []
    rotations = np.empty((len(times), len(bones), 4))
    locations = np.zeros((len(times), len(bones), 3))
    for index, bone in enumerate(bones):
        name, width = rotation_of(bone)
        now = getattr(bone, name)[:width]
        channels.append(evaluate_channels(curves, path_of(bone, name), now, times))
        rotations[:, index] = read_rotations(bone.rotation_mode, channels[index])
        if not bone.bone.use_connect:
            path = path_of(bone, "location")
            locations[:, index] = evaluate_channels(curves, path, bone.location, times)
    places = read_places(obj, curves, times)
    rest = [places[0] @ np.array(bone.bone.matrix_local) for bone in bones]
    tails = [places[0] @ np.array([*bone.bone.tail_local, 1.0]) for bone in bones]
    indices = [names.index(parents[name]) if parents[name] else -1 for name in names]
    armature = Armature(tuple(names), tuple(indices), np.array(rest), np.array(tails)[:, :3])
    poses = Poses(rotations, locations, places @ np.linalg.inv(places[0]))
    step = float(times[-1] - times[0]) / (len(times) - 1)
    motion = to_motion(armature, poses, rate / step)
    rig_of(motion)
    return Reading(armature, poses, motion, times, channels)


def write_motion(obj, curves, reading, motion):
    """Key what differs from what was read, and return the number of bones and of frames."""
    poses = to_poses(reading.armature, motion, reading.poses.places)
    rotated, moved = find_changes(reading.motion, motion)
    bones = set()
    frames = np.zeros(len(reading.times), bool)
    for index, name in enumerate(reading.armature.names):
        bone = obj.pose.bones[name]
        is_moved = moved[:, index] & (not bone.bone.use_connect)
        if rotated[:, index].any():
            values = reading.channels[index].copy()
            for first, end in runs(rotated[:, index]):
                turns = poses.rotations[first:end, index]
                before = values[max(first - 1, 0)]
                values[first:end] = write_rotations(bone.rotation_mode, turns, before)
            path = path_of(bone, rotation_of(bone)[0])
            write_channels(curves, path, reading.times, values, rotated[:, index])
        if is_moved.any():
            values = reading.poses.locations[:, index].copy()
            values[is_moved] = poses.locations[is_moved, index]
            path = path_of(bone, "location")
            write_channels(curves, path, reading.times, values, is_moved)
        changed = rotated[:, index] | is_moved
        if changed.any():
            bones.add(name)
            frames |= changed
    return len(bones), int(frames.sum())


def write_channels(curves, path, times, values, changed):
    """Key the channels (F, N) of a property in the frames in which they change."""
    for index, column in enumerate(values.T):
        curve = curves.find(path, index=index)
        if curve is None:
            curve = curves.new(path, index=index)
        write_curve(curve, times, column, changed)


def write_curve(curve, times, values, changed):
    """Key a curve in the frames that change, and where it would else change beside them."""
    remove_keys_between(curve, times, changed)
    keys = key_array(curve, "co", 2)
    key_times = keys[:, 0].astype(np.float64)
    chosen = choose_keys(key_times, times, changed)
    frames = find_frames(key_times, times)
    changes = np.where((frames >= 0) & chosen[frames], values[frames] - keys[:, 1], 0.0)
    for name in ("co", "handle_left", "handle_right"):
        points = key_array(curve, name, 2)
        points[:, 1] += changes
        curve.keyframe_points.foreach_set(name, points.ravel())
    chosen[frames[frames >= 0]] = False
    if chosen.any():
        hold_handles(curve, times, changed)
    for frame in np.flatnonzero(chosen):
        curve.keyframe_points.insert(times[frame], values[frame], options={"FAST"})
    curve.update()


def remove_keys_between(curve, times, changed):
    """Remove the keys between two frames one of which changes: they have the values of before."""
    keys = key_array(curve, "co", 2)[:, 0].astype(np.float64)
    after = np.searchsorted(times, keys)
    is_between = (find_frames(keys, times) < 0) & (after > 0) & (after < len(times))
    for index in np.flatnonzero(is_between)[::-1]:
        if changed[after[index] - 1] or changed[after[index]]:
            curve.keyframe_points.remove(curve.keyframe_points[index], fast=True)


def hold_handles(curve, times, changed):
    """Fix the handles of the keys before and after the frames that change, so that the curve beyond
    these keys stays."""
    keys = key_array(curve, "co", 2)[:, 0]
    for first, end in runs(changed):
        before = np.flatnonzero(keys < times[first] - LEAST_DIFFERENCE)[-1:]
        after = np.flatnonzero(keys > times[end - 1] + LEAST_DIFFERENCE)[:1]
        for index in (*before, *after):
            point = curve.keyframe_points[index]
            point.handle_left_type = "FREE"
            point.handle_right_type = "FREE"


KEY_PROPERTIES = {
    "co": 2,
    "handle_left": 2,
    "handle_right": 2,
    "interpolation": 1,
    "easing": 1,
    "handle_left_type": 1,
    "handle_right_type": 1,
    "amplitude": 1,
    "back": 1,
    "period": 1,
}
"""The properties of a key that make a curve, and the number of values of each."""


def restore_curves(curves, originals):
    """Give the curves of an action the keys of those of its copy."""
    for curve in list(curves):
        original = originals.find(curve.data_path, index=curve.array_index)
        if original is None:
            curves.remove(curve)
        elif not np.array_equal(key_array(curve, "co", 2), key_array(original, "co", 2)):
            copy_keys(original, curve)


def copy_keys(source, target):
    """Give a curve all keys of another one."""
    target.keyframe_points.clear()
    target.keyframe_points.add(len(source.keyframe_points))
    for name, width in KEY_PROPERTIES.items():
        is_number = name in ("amplitude", "back", "period") or width == 2
        values = np.empty(len(source.keyframe_points) * width, np.float32 if is_number else np.intc)
        source.keyframe_points.foreach_get(name, values)
        target.keyframe_points.foreach_set(name, values)
    target.update()


def fingerprint_of(curves):
    """A text that differs if any key of some curves has another time or value."""
    digest = hashlib.sha256()
    for curve in sorted(curves, key=lambda curve: (curve.data_path, curve.array_index)):
        digest.update(f"{curve.data_path} {curve.array_index}".encode())
        digest.update(key_array(curve, "co", 2).tobytes())
    return digest.hexdigest()


def begin_list(obj):
    """Keep a copy of the action, and forget the list of another state of it."""
    action, slot = require_action(obj)
    settings = obj.numpy_cae
    end_list(settings)
    settings.original = action.copy()
    settings.original.name = action.name + COPY_SUFFIX
    settings.fingerprint = fingerprint_of(curves_of(action, slot))


def end_list(settings):
    """Forget the list and the copy of the action."""
    settings.findings.clear()
    settings.fingerprint = ""
    settings.notes = ""
    original = settings.original
    settings.original = None
    if original is not None and original.users == 0:
        bpy.data.actions.remove(original)


def is_current(obj):
    """Whether there is a list for the action as it is."""
    settings = obj.numpy_cae
    if settings.original is None:
        return False
    action, slot = require_action(obj)
    return settings.fingerprint == fingerprint_of(curves_of(action, slot))


def preview_range(scene):
    """The first and the last frame of the preview range; None where there is none."""
    if not scene.use_preview_range:
        return None
    return scene.frame_preview_start, scene.frame_preview_end


def selected_bones(obj):
    """The names of the selected bones."""
    names = []
    for bone in obj.pose.bones:
        # Blender 4.5 keeps it in the bone of the rest pose.
        is_selected = bone.select if hasattr(bone, "select") else bone.bone.select
        if is_selected:
            names.append(bone.name)
    return names


def list_finding(settings, reading, finding):
    """Add a finding to the list of an object."""
    first, last = finding.frames
    row = settings.findings.add()
    row.accept = finding.is_repaired
    row.joint = finding.joint
    row.bone = bone_of(reading.motion, finding.joint)
    row.first = reading.times[first]
    row.last = reading.times[last]
    row.kind = finding.kind
    row.moved = finding.movement_in_words()
    row.evidence = finding.evidence
    row.status = STATUS_WORDS[finding.status]
    row.confidence = finding.confidence
    row.data = json.dumps(finding.to_json())


def bone_of(motion, joint):
    """The name of the bone of a joint; that of the hips for the body."""
    if joint not in (BODY, *JOINTS):
        return joint
    column = 0 if joint == BODY else JOINTS.index(joint)
    return motion.skeleton.names[rig_of(motion).joints[column]]


def find_damage(context, obj, report_progress=None):
    """List what is damaged in the action of an armature, and return the number of findings."""
    action, slot = require_action(obj)
    reading = read_action(context.scene, obj, curves_of(action, slot))
    repaired = repair_motion(reading.motion, starter(), progress=report_progress)
    begin_list(obj)
    settings = obj.numpy_cae
    selected = selected_bones(obj)
    frames = preview_range(context.scene)
    for finding in repaired.listed():
        first, last = reading.times[list(finding.frames)]
        if frames and (last < frames[0] or first > frames[1]):
            continue
        if settings.only_selected and bone_of(reading.motion, finding.joint) not in selected:
            continue
        list_finding(settings, reading, finding)
    notes = []
    for note in reading.motion.notes:
        if note.kind != "unit" or note.in_doubt:
            notes.append(note.text)
    if repaired.cuts:
        cut_times = [round(float(reading.times[cut])) for cut in repaired.cuts]
        notes.append(cuts_in_words(cut_times))
    if not repaired.is_familiar:
        notes.append("unlike what the model knows: it predicts only what you mark")
    settings.notes = "\n".join(notes)
    return len(settings.findings)


def mark_bones(context, obj):
    """List the selected bones in the preview range, to be filled in; return their number."""
    frames = preview_range(context.scene)
    if frames is None:
        raise ValueError("choose the frames by a preview range (P in the timeline)")
    names = selected_bones(obj)
    if not names:
        raise ValueError("select the bones in pose mode")
    action, slot = require_action(obj)
    reading = read_action(context.scene, obj, curves_of(action, slot))
    inside = np.flatnonzero((reading.times >= frames[0]) & (reading.times <= frames[1]))
    if not len(inside):
        raise ValueError("the bones have no keys in the preview range")
    if len(inside) == len(reading.times):
        raise ValueError("the preview range has all frames; leave some that are right")
    findings = []
    for name in names:
        joint = JOINTS[joint_index(name, reading.motion)]
        findings.append(Finding(joint, (int(inside[0]), int(inside[-1])), MARKED.name))
    require_movable(findings, reading.motion)
    if not is_current(obj):
        begin_list(obj)
    for finding in findings:
        list_finding(obj.numpy_cae, reading, finding)
    return len(findings)


def apply_findings(context, obj, report_progress=None):
    """Write the repair of what is ticked into the action; return the number of bones and frames
    that differ from the action as it was."""
    action, slot = require_action(obj)
    settings = obj.numpy_cae
    if not is_current(obj):
        raise ValueError("the action was changed since the search; search again")
    curves = curves_of(action, slot)
    originals = curves_of_copy(settings, slot)
    reading = read_action(context.scene, obj, originals)
    accepted = []
    for row in settings.findings:
        finding = Finding.from_json(json.loads(row.data))
        if row.accept:
            accepted.append(replace(finding, status="repaired"))
        elif finding.row is T_POSE:
            accepted.append(finding)
    motion: Motion = reading.motion
    if accepted:
        repaired = repair_motion(motion, starter(), findings=accepted, progress=report_progress)
        motion = weaken(repaired, settings.strength).motion
    restore_curves(curves, originals)
    changed = write_motion(obj, curves, reading, motion)
    settings.fingerprint = fingerprint_of(curves)
    return changed


def jump_to_finding(settings, context):
    """Go to the first frame of the finding that is chosen in the list, and make its bone active."""
    if not 0 <= settings.active < len(settings.findings):
        return
    row = settings.findings[settings.active]
    frame = int(np.floor(row.first))
    context.scene.frame_set(frame, subframe=row.first - frame)
    bones = settings.id_data.data.bones
    if row.bone in bones:
        bones.active = bones[row.bone]


class FindingRow(bpy.types.PropertyGroup):
    """A finding in the list; `data` is the finding as an object of a file of findings."""

    accept: BoolProperty(name="Accept", description="Repair this when the list is applied")
    joint: StringProperty()
    bone: StringProperty()
    first: FloatProperty()
    last: FloatProperty()
    kind: StringProperty()
    moved: StringProperty()
    evidence: StringProperty()
    status: StringProperty()
    confidence: FloatProperty()
    data: StringProperty()


class Settings(bpy.types.PropertyGroup):
    """The list of an armature."""

    only_selected: BoolProperty(
        name="Only Selected Bones", description="List what is found at the selected bones"
    )
    strength: FloatProperty(
        name="Strength",
        description="0 leaves the motion as it is, 1 is the repair",
        min=0.0,
        max=1.0,
        default=1.0,
        subtype="FACTOR",
    )
    findings: CollectionProperty(type=FindingRow)
    active: IntProperty(update=jump_to_finding)
    original: PointerProperty(type=bpy.types.Action)
    fingerprint: StringProperty()
    notes: StringProperty()


class ArmatureOperator:
    """What the operators have in common: an active armature, and errors as sentences."""

    bl_options: ClassVar = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        obj = context.object
        return obj is not None and obj.type == "ARMATURE"

    def execute(self, context):
        manager = context.window_manager
        manager.progress_begin(0, 100)
        try:
            message = self.work(context, context.object, partial(show_progress, manager))
        except (ValueError, MemoryError) as error:
            self.report({"ERROR"}, str(error) or "not enough memory")
            return {"CANCELLED"}
        finally:
            manager.progress_end()
        self.report({"INFO"}, message)
        return {"FINISHED"}


def show_progress(manager, share):
    """Show the share of the work that is done beside the pointer."""
    manager.progress_update(100 * share)


class FindDamage(ArmatureOperator, bpy.types.Operator):
    """List what is damaged in the action; nothing is changed yet"""

    bl_idname = "numpy_cae.find"
    bl_label = "Find Damage"

    def work(self, context, obj, progress):
        return f"{count(find_damage(context, obj, progress), 'finding')}"


class MarkBones(ArmatureOperator, bpy.types.Operator):
    """Add the selected bones in the preview range to the list, to be filled in"""

    bl_idname = "numpy_cae.mark"
    bl_label = "Mark Bones"

    def work(self, context, obj, progress):
        return f"{count(mark_bones(context, obj), 'bone')} marked"


class ApplyFindings(ArmatureOperator, bpy.types.Operator):
    """Repair what is ticked, with the strength below; what is not ticked is as before"""

    bl_idname = "numpy_cae.apply"
    bl_label = "Apply"

    def work(self, context, obj, progress):
        bones, frames = apply_findings(context, obj, progress)
        return f"{count(bones, 'bone')} changed in {count(frames, 'frame')}"


class EndRepair(ArmatureOperator, bpy.types.Operator):
    """Clear the list and remove the copy of the action; the action stays as it is"""

    bl_idname = "numpy_cae.end"
    bl_label = "Done"

    def work(self, context, obj, progress):
        end_list(obj.numpy_cae)
        return "the list is empty"


class FindingList(bpy.types.UIList):
    """The list of findings."""

    bl_idname = "NUMPY_CAE_UL_findings"

    def draw_item(self, context, layout, data, row, icon, active_data, active_name):
        layout.prop(row, "accept", text="")
        columns = layout.split(factor=0.4)
        columns.label(text=row.bone)
        columns = columns.split(factor=0.5)
        columns.label(text=f"{row.first:g}–{row.last:g}")
        columns.label(text=row.kind)


def draw_finding(layout, row):
    """What a row of the list has no room for."""
    for text in (row.evidence, row.moved, f"confidence {row.confidence:.2f}", row.status):
        if text:
            layout.label(text=text)


class RepairPanel(bpy.types.Panel):
    """The panel in the sidebar of the 3D viewport."""

    bl_idname = "NUMPY_CAE_PT_repair"
    bl_label = "Repair Motion"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "numpy_cae"

    @classmethod
    def poll(cls, context):
        return ArmatureOperator.poll(context)

    def draw(self, context):
        layout = self.layout
        settings = context.object.numpy_cae
        frames = preview_range(context.scene)
        words = f"frames {frames[0]} to {frames[1]} (preview range)" if frames else "all frames"
        layout.label(text=words.capitalize(), icon="TIME")
        layout.prop(settings, "only_selected")
        row = layout.row(align=True)
        row.operator(FindDamage.bl_idname, icon="VIEWZOOM")
        row.operator(MarkBones.bl_idname, icon="ADD")
        layout.template_list(
            FindingList.bl_idname, "", settings, "findings", settings, "active", rows=6
        )
        if 0 <= settings.active < len(settings.findings):
            draw_finding(layout.column(align=True), settings.findings[settings.active])
        layout.prop(settings, "strength")
        row = layout.row(align=True)
        row.operator(ApplyFindings.bl_idname, icon="CHECKMARK")
        row.operator(EndRepair.bl_idname)
        for note in settings.notes.splitlines():
            layout.label(text=note, icon="INFO")


CLASSES = (
    *(FindingRow, Settings, FindDamage, MarkBones, ApplyFindings, EndRepair),
    *(FindingList, RepairPanel),
)


def register():
    """Called by Blender when the add-on is enabled."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.numpy_cae = PointerProperty(type=Settings)


def unregister():
    """Called by Blender when the add-on is disabled."""
    del bpy.types.Object.numpy_cae
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
