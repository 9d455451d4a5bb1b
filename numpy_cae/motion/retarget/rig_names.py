"""The names of joints in common rigs.

A rig is a table from our joint names to its own, each with alternatives. Where it names no spine
or chest, they follow from the hierarchy (`numpy_cae.motion.retarget.rigs`): rigs of one family
differ in their number of spine joints. Blanks and punctuation in names do not matter.
"""

from itertools import product

from numpy_cae.motion.joints import JOINTS

Names = dict[str, tuple[str, ...]]
"""For each of our joint names, the names that it may have in a rig, the usual one first."""

_LIMBS = ("collar", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")


def _rig(trunk: str, limbs: str, sides: str, prefixes: str = "") -> Names:
    """The table of a rig; | separates alternatives.

    `trunk` names hips and head, or hips, spine, chest and head; `sides` are the patterns for left
    and right, such as "Left{} Right{}"; every name may have one of the prefixes.
    """
    trunk_names = trunk.split()
    joints = ("hips", "head") if len(trunk_names) == 2 else ("hips", "spine", "chest", "head")
    names = {joint: each.split("|") for joint, each in zip(joints, trunk_names, strict=True)}
    for side, patterns in zip(("left", "right"), sides.split(), strict=True):
        for joint, each in zip(_LIMBS, limbs.split(), strict=True):
            options = product(patterns.split("|"), each.split("|"))
            names[f"{side}_{joint}"] = [pattern.format(name) for pattern, name in options]
    return {
        joint: tuple(prefix + name for prefix, name in product(prefixes.split("|"), each))
        for joint, each in names.items()
    }


_MOTIONBUILDER = "Shoulder Arm ForeArm Hand UpLeg Leg Foot ToeBase|Toe"
_UNITY = "Shoulder UpperArm LowerArm Hand UpperLeg LowerLeg Foot Toes|ToeBase"
_BIPED = "Clavicle UpperArm ForeArm Hand Thigh Calf Foot ToeBase|Toe0"

RIGS: dict[str, Names] = {
    "numpy_cae": {joint: (joint,) for joint in JOINTS},
    "CMU Acclaim": _rig(
        "root upperback thorax head",
        "clavicle humerus radius wrist femur tibia foot toes",
        "l{} r{}",
    ),
    "Mixamo": _rig("Hips Spine Spine2 Head", _MOTIONBUILDER, "Left{} Right{}", "|mixamorig"),
    "CMU BVH": _rig("Hips Spine Spine1 Head", _MOTIONBUILDER, "Left{} Right{}"),
    "Bandai": _rig("Hips Spine Chest Head", _UNITY, "{}_L {}_R"),
    "MotionBuilder, Perception Neuron": _rig(
        "Hips Head", _MOTIONBUILDER, "Left{} Right{}", "|Robot_|Character1_|mixamorig"
    ),
    "Character Creator, iClone": _rig("Hip Head", _BIPED, "L_{} R_{}", "CC_Base_"),
    "3ds Max Biped": _rig("Pelvis Head", _BIPED, "L_{} R_{}", "Bip01_|Bip001_|"),
    "LeftHip, LeftCollar (Biovision, 100STYLE)": _rig(
        "Hips|Hip Head",
        "Collar Shoulder|UpArm Elbow|LowArm Wrist|Hand Hip|UpLeg Knee|LowLeg Ankle|Foot Toe",
        "Left{} Right{}",
    ),
    "Unreal": _rig(
        "pelvis head", "clavicle upperarm lowerarm hand thigh calf foot ball", "{}_l {}_r"
    ),
    "Rokoko": _rig("Hips Head", "Shoulder Arm ForeArm Hand Thigh Shin Foot Toe", "Left{} Right{}"),
    "SOMA": _rig("Hips Head", "Shoulder Arm ForeArm Hand Leg Shin Foot ToeBase", "Left{} Right{}"),
    "Xsens": _rig(
        "Pelvis Head",
        "Shoulder UpperArm ForeArm Hand UpperLeg LowerLeg Foot Toe",
        "Left{} Right{}",
    ),
    "Rigify": _rig(
        "hips|spine spine.006|head",
        "shoulder upper_arm forearm hand thigh shin foot toe",
        "{}.L {}.R",
        "DEF-|ORG-|",
    ),
    "VRM, Unity": _rig("hips head", _UNITY, "left{} right{}"),
    "VRoid": _rig("C_Hips C_Head", _UNITY, "L_{} R_{}", "J_Bip_"),
    "Daz Genesis, Poser": _rig(
        "hip head",
        "Collar ShldrBend|Shldr ForearmBend|ForeArm Hand ThighBend|Thigh Shin Foot Toe",
        "l{} r{}",
    ),
    "Daz Genesis 9": _rig(
        "hip head", "shoulder|clavicle upperarm forearm hand thigh shin foot toes|toe", "l_{} r_{}"
    ),
    "SMPL": _rig(
        "pelvis head",
        "collar|thorax shoulder elbow wrist hip knee ankle foot|toe",
        "left_{}|L_{} right_{}|R_{}",
        "|m_avg_",
    ),
}
