"""Convert the animation of the first armature of an FBX file to BVH, by Blender.

blender --background --python fbx_to_bvh.py -- take.fbx take.bvh
python fbx_to_bvh.py -- take.fbx take.bvh          (where `pip install bpy` was done)
"""

import sys

import bpy


def convert(source: str, target: str) -> None:
    """Read an FBX file and write the armature's motion over the frames of its action."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.fbx(filepath=source)
    armatures = [thing for thing in bpy.data.objects if thing.type == "ARMATURE"]
    if not armatures:
        sys.exit(f"{source}: no armature; is it exported with its skeleton?")
    armature = armatures[0]
    if not armature.animation_data or not armature.animation_data.action:
        sys.exit(f"{source}: no animation; bake it onto the skeleton before the export")
    bpy.context.view_layer.objects.active = armature
    first, last = armature.animation_data.action.frame_range
    bpy.ops.export_anim.bvh(
        filepath=target,
        frame_start=round(first),
        frame_end=round(last),
        root_transform_only=True,
    )


if __name__ == "__main__":
    convert(*sys.argv[sys.argv.index("--") + 1 :])
