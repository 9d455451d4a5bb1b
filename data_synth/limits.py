"""The angles of each joint as a clinician measures them, and their limits.

Ranges are those of the American Academy of Orthopaedic Surgeons (Greene & Heckman, *The Clinical
Measurement of Joint Motion*, 1994) with the spread of healthy adults in Soucie et al.,
*Haemophilia* 17 (2011) 500. Where weight or an exercise bends a joint further than its muscles can
(the ankle in a squat, toes and wrists in a press-up) the passive range holds. The trunk's and the
neck's three joints each have the range of the CMU database's Acclaim skeletons.
"""

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation

from data_synth.body import SIDES, SIGN
from numpy_cae.motion import Motion

Angles = dict[str, np.ndarray]

_TRUNK: dict[str, tuple[float, float]] = {
    "forwards": (-20, 45),
    "left": (-30, 30),
    "twist": (-30, 30),
}
LIMITS: dict[str, dict[str, tuple[float, float]]] = {
    "femur": {"flexion": (-30, 125), "abduction": (-30, 50), "turn": (-50, 50)},
    "tibia": {"flexion": (0, 150), "other": (-0.01, 0.01)},
    "foot": {"dorsiflexion": (-55, 45), "turn": (-40, 40), "inversion": (-40, 40)},
    "toes": {"dorsiflexion": (-30, 85), "other": (-0.01, 0.01)},
    "clavicle": {"raised": (-10, 40), "forwards": (-25, 30)},
    "humerus": {"extension": (-90, 60), "adduction": (-90, 50), "turn": (-105, 105)},
    "radius": {"flexion": (0, 150), "other": (-0.01, 0.01)},
    "wrist": {"pronation": (-90, 95), "other": (-0.01, 0.01)},
    "hand": {"flexion": (-95, 85), "deviation": (-45, 45)},
    "fingers": {"flexion": (-30, 95), "other": (-0.01, 0.01)},
    "thumb": {"flexion": (-30, 60), "other": (-0.01, 0.01)},
    **{name: _TRUNK for name in ("lowerback", "upperback", "thorax")},
    **{name: _TRUNK for name in ("lowerneck", "upperneck", "head")},
}
"""Degrees. "other" is rotation about an axis that the joint does not have."""


def joint_angles(motion: Motion) -> dict[tuple[str, str], np.ndarray]:
    """The clinical angles of every joint that has limits.

    Parameters
    ----------
    motion : Motion
        Of a body of this package: T-pose, left along +X, facing +Z.

    Returns
    -------
    dict of (joint, angle) to (F,) array
        Degrees; such as ``("lfemur", "flexion")``.
    """
    angles = {}
    for joint, name in enumerate(motion.skeleton.names):
        if name in LIMITS:
            bone = name
            sign = SIGN[0]
        elif name[1:] in LIMITS:
            bone = name[1:]
            sign = SIGN[SIDES.index(name[0])]
        else:
            continue
        rotation = Rotation.from_quat(motion.rotations[:, joint])
        measured = _measures(bone)(rotation, sign)
        for angle, values in measured.items():
            angles[name, angle] = np.degrees(values)
    return angles


def beyond_limits(motion: Motion) -> list[str]:
    """One line for each angle that exceeds its limits."""
    lines = []
    for (name, angle), values in joint_angles(motion).items():
        low, high = LIMITS[name if name in LIMITS else name[1:]][angle]
        worst = int(np.argmax(np.maximum(low - values, values - high)))
        if not low <= values[worst] <= high:
            lines.append(
                f"{name} {angle} is {values[worst]:.1f}° in frame {worst}, limits {low}° to {high}°"
            )
    return lines


def _measures(bone: str) -> Callable[[Rotation, float], Angles]:
    joints = {
        "femur": _hip,
        "humerus": _shoulder,
        "hand": _hand,
        "clavicle": _collar,
        "foot": _ankle,
    }
    if bone in joints:
        return joints[bone]
    if bone in ("tibia", "toes", "radius", "wrist", "fingers", "thumb"):
        return lambda rotation, sign: _hinge(bone, rotation, sign)
    return _trunk


def _turn_about(axis: int, rotation: Rotation) -> np.ndarray:
    """The part of a rotation about one axis (swing and twist)."""
    quaternion = rotation.as_quat()
    turn = 2 * np.arctan2(quaternion[:, axis], quaternion[:, 3])
    return (turn + np.pi) % (2 * np.pi) - np.pi


def _hinge(bone: str, rotation: Rotation, sign: float) -> Angles:
    axis, direction, name = {
        "tibia": (0, 1.0, "flexion"), "toes": (0, -1.0, "dorsiflexion"),
        "radius": (1, -sign, "flexion"), "wrist": (0, 1.0, "pronation"),
        "fingers": (2, -sign, "flexion"), "thumb": (1, -sign, "flexion"),
    }[bone]  # fmt: skip
    off_axis = np.delete(rotation.as_quat()[:, :3], axis, axis=1)
    return {
        name: direction * _turn_about(axis, rotation),
        "other": 2 * np.arcsin(np.minimum(np.linalg.norm(off_axis, axis=-1), 1.0)),
    }


def _hip(rotation: Rotation, sign: float) -> Angles:
    thigh = rotation.apply([0.0, -1.0, 0.0])
    return {
        "flexion": np.arctan2(thigh[:, 2], -thigh[:, 1]),
        "abduction": np.arcsin(np.clip(sign * thigh[:, 0], -1, 1)),
        "turn": _turn_about(1, rotation),
    }


def _shoulder(rotation: Rotation, sign: float) -> Angles:
    # Its own turn is measured against the hanging arm, whichever way it was lifted. Overhead that
    # depends on the way (Codman's paradox), and within 40° of straight up nothing is measured.
    hanging = rotation * Rotation.from_euler("z", sign * np.pi / 2)
    arm = rotation.apply([sign, 0.0, 0.0])
    overhead = arm[:, 1] > np.cos(np.radians(40))
    return {
        "extension": np.arcsin(np.clip(-arm[:, 2], -1, 1)),
        "adduction": np.arcsin(np.clip(-sign * arm[:, 0], -1, 1)),
        "turn": np.where(overhead, 0.0, sign * _turn_about(1, hanging)),
    }


def _hand(rotation: Rotation, sign: float) -> Angles:
    palm = rotation.apply([sign, 0.0, 0.0])
    return {
        "flexion": np.arctan2(-palm[:, 1], sign * palm[:, 0]),
        "deviation": np.arcsin(np.clip(palm[:, 2], -1, 1)),
    }


def _collar(rotation: Rotation, sign: float) -> Angles:
    bone = rotation.apply([sign, 0.0, 0.0])
    return {
        "raised": np.arcsin(np.clip(bone[:, 1], -1, 1)),
        "forwards": np.arctan2(bone[:, 2], sign * bone[:, 0]),
    }


def _ankle(rotation: Rotation, sign: float) -> Angles:
    yaw, pitch, roll = rotation.as_euler("YXZ").T
    return {"dorsiflexion": -pitch, "turn": yaw, "inversion": roll}


def _trunk(rotation: Rotation, sign: float) -> Angles:
    twist, forwards, right = rotation.as_euler("YXZ").T
    return {"forwards": forwards, "left": -right, "twist": twist}
