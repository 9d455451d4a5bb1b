"""Convert the animation of the first armature of an FBX or glTF file to BVH, by Blender.

blender --background --python fbx_to_bvh.py -- take.fbx take.bvh
blender --background --python fbx_to_bvh.py -- take.glb take.bvh 30
python fbx_to_bvh.py -- take.fbx take.bvh          (where `pip install bpy` was done)

glTF has times and no frames: the number after the files is how many frames a second are written.
"""

import sys

import bpy


def convert(source: str, target: str, rate: str = "30") -> None:
    """Read a file and write the armature's motion over the frames of its action; of glTF, at `rate`
    frames a second."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    if source.lower().endswith((".glb", ".gltf")):
        bpy.context.scene.render.fps = int(rate)
        bpy.ops.import_scene.gltf(filepath=source)
    else:
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
