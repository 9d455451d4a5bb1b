"""From a `Pose` to the rotation of every joint.

From the pelvis to the leaves, each joint's rotation is R = G_parent⁻¹ · G.
Legs, and arms with a goal for the hand, bend by two-bone inverse kinematics.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from data_synth.body import SIDES, SIGN, Body
from data_synth.pose import Arm, Leg, Pose
from data_synth.two_bones import frames_from, reach, unit
from numpy_cae.motion import Motion

# How three joints in a row share a bend: the lumbar spine bends, the thoracic spine twists
# (White & Panjabi, 1990, Clinical Biomechanics of the Spine, chapter 2).
_SPINE = {
    "lowerback": (0.42, 0.34, 0.15),
    "upperback": (0.33, 0.33, 0.35),
    "thorax": (0.25, 0.33, 0.50),
}
_NECK = {
    "lowerneck": (0.40, 0.35, 0.25),
    "upperneck": (0.35, 0.35, 0.40),
    "head": (0.25, 0.30, 0.35),
}


def about(axis: str, angles: np.ndarray) -> Rotation:
    """Rotations about one axis by (F,) radians, or by (F, n) about several, intrinsic."""
    angles = angles[:, None] if len(axis) == 1 else angles
    return Rotation.from_euler(axis.upper(), angles)


def bend_joint(forwards: np.ndarray, left: np.ndarray, twist: np.ndarray) -> Rotation:
    """The rotation of a joint bent forwards, to the left and twisted to the left, radians (F,)."""
    return about("YXZ", np.stack([twist, forwards, -left], axis=-1))


def assemble(body: Body, pose: Pose, rate: float) -> Motion:
    """The motion of a body in a sequence of poses.

    Parameters
    ----------
    body : Body
    pose : Pose of F frames
    rate : float
        Frames a second.

    Returns
    -------
    Motion
    """
    frames = len(pose)
    skeleton = body.skeleton
    still = Rotation.identity(frames)
    local = {name: still for name in skeleton.names}
    local["root"] = pose.pelvis
    chest, trunk, bends = bend_trunk(body, pose.place, pose.pelvis, pose.spine)
    local |= bends | {
        name: bend_joint(*(pose.neck * np.array(share)).T) for name, share in _NECK.items()
    }
    for side in (0, 1):
        _bend_leg(body, pose, pose.legs[side], side, local)
        _bend_arm(body, chest, trunk, pose.arms[side], side, local)
    rotations = np.stack([local[name].as_quat() for name in skeleton.names], axis=1)
    translations = np.broadcast_to(skeleton.offsets, (frames, *skeleton.offsets.shape)).copy()
    translations[:, 0] = pose.place
    return Motion(skeleton, float(rate), _unbroken(rotations), translations)


def _unbroken(rotations: np.ndarray) -> np.ndarray:
    """The same rotations; the sign of each quaternion is that nearest to the frame before."""
    agree = np.sum(rotations[1:] * rotations[:-1], axis=-1)
    flips = np.cumprod(np.where(agree < 0, -1.0, 1.0), axis=0)
    rotations[1:] *= flips[..., None]
    return rotations


def bend_trunk(
    body: Body, place: np.ndarray, pelvis: Rotation, spine: np.ndarray
) -> tuple[np.ndarray, Rotation, dict[str, Rotation]]:
    """The base of the collar bones (F, 3), the chest's global rotation, the spine's rotations."""
    bends = {name: bend_joint(*(spine * np.array(share)).T) for name, share in _SPINE.items()}
    turned = pelvis
    at = place
    for name, above in zip(_SPINE, ("upperback", "thorax", "lowerneck"), strict=True):
        turned = turned * bends[name]
        at = at + turned.apply(body.offset(above))
    return at, turned, bends


def _bend_leg(body: Body, pose: Pose, leg: Leg, side: int, local: dict) -> None:
    hip = pose.place + pose.pelvis.apply(body.hip(side))
    across = unit(pose.pelvis.apply([1.0, 0.0, 0.0]) + leg.foot.apply([1.0, 0.0, 0.0]))
    along = unit(leg.ankle - hip)
    # Turning the hinge about the line from hip to ankle swings the knee out and in.
    hinge = Rotation.from_rotvec(-along * (SIGN[side] * leg.splay)[:, None]).apply(across)
    hinge = unit(hinge - np.sum(hinge * along, axis=-1, keepdims=True) * along)
    knee, ankle = reach(hip, leg.ankle, body.thigh, body.shank, hinge)
    thigh = frames_from(hinge, hip - knee)
    shank = frames_from(thigh.apply([1.0, 0.0, 0.0]), knee - ankle)
    name = SIDES[side]
    local[f"{name}femur"] = pose.pelvis.inv() * thigh
    local[f"{name}tibia"] = thigh.inv() * shank
    local[f"{name}foot"] = shank.inv() * leg.foot
    local[f"{name}toes"] = about("x", -leg.toes)


def _bend_arm(
    body: Body, chest: np.ndarray, trunk: Rotation, arm: Arm, side: int, local: dict
) -> None:
    name = SIDES[side]
    sign = SIGN[side]
    collar = about("YZ", np.stack([-sign * arm.forwards, sign * arm.raised], axis=-1))
    # The arm of the T-pose is let down by 90°, then lifted outwards, then swung forwards.
    angles = [-arm.flexion, sign * (arm.abduction - np.pi / 2), arm.turn]
    shoulder = about("XZX", np.stack(angles, axis=-1))
    # Shoulder angles are relative to the trunk: the collar bone lifts the shoulder, not the arm.
    shoulder = collar.inv() * shoulder
    elbow = about("y", -sign * arm.elbow)
    hand = about("z", -sign * arm.wrist)
    local[f"{name}clavicle"] = collar
    local[f"{name}wrist"] = about("x", arm.pronation)
    if arm.goal is not None:
        assert arm.goal_weight is not None
        start = chest + (trunk * collar).apply(body.offset(f"{name}humerus"))
        reaching = _reach_with_arm(body, start, trunk, arm, sign)
        shoulder = blend(shoulder, (trunk * collar).inv() * reaching[0], arm.goal_weight)
        elbow = blend(elbow, reaching[0].inv() * reaching[1], arm.goal_weight)
        if arm.hand is not None:
            forearm = reaching[1] * local[f"{name}wrist"]
            hand = blend(hand, forearm.inv() * arm.hand, arm.goal_weight)
    local[f"{name}humerus"] = shoulder
    local[f"{name}radius"] = elbow
    local[f"{name}hand"] = hand
    local[f"{name}fingers"] = about("z", -sign * arm.curl)
    local[f"{name}thumb"] = about("y", -sign * 0.3 * arm.curl)


def _reach_with_arm(
    body: Body, shoulder: np.ndarray, trunk: Rotation, arm: Arm, sign: float
) -> tuple[Rotation, Rotation]:
    assert arm.goal is not None and arm.elbow_side is not None
    side = trunk.apply(arm.elbow_side)
    hinge = np.cross(shoulder - arm.goal, side)
    elbow, wrist = reach(shoulder, arm.goal, body.upper_arm, body.forearm, hinge)
    axis = np.cross(elbow - shoulder, wrist - elbow)
    up = -sign * axis
    upper = frames_from_x(sign * (elbow - shoulder), up)
    lower = frames_from_x(sign * (wrist - elbow), up)
    return upper, lower


def frames_from_x(x: np.ndarray, y: np.ndarray) -> Rotation:
    """The rotations whose axis X points along x exactly, and Y as nearly along y as possible."""
    x = unit(x)
    y = unit(y - np.sum(x * y, axis=-1, keepdims=True) * x)
    return Rotation.from_matrix(np.stack([x, y, np.cross(x, y)], axis=-1))


def blend(start: Rotation, end: Rotation, weight: np.ndarray) -> Rotation:
    """Interpolate from one rotation (weight 0) to the other (weight 1) in each frame."""
    way = (start.inv() * end).as_rotvec()
    return start * Rotation.from_rotvec(way * np.asarray(weight)[:, None])
