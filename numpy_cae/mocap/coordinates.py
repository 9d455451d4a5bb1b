"""The up axis and the floor of a motion file: detected, and changed to Y up and 0.

Nearly all files have Y up and the floor at 0; such files pass through unchanged. Two observations
decide, on the twenty joints:

- Upright: the median direction from the ankles to the head. People stand, walk and sit upright; if
  it is along another axis, that axis is up, unless the body rests on the floor at Y = 0, as someone
  who does press-ups or lies. A body whose head is below its feet in most frames hangs: -Y is up.
- Support: the lowest joint is near the floor most of the time. If the lowest level at which it
  stays is far from 0, and it is seldom near 0, the floor is there.
"""

from dataclasses import dataclass, replace

import numpy as np

from numpy_cae.mocap.axes import TO_Y_UP, to_y_up
from numpy_cae.mocap.rigs.completed import sampled
from numpy_cae.mocap.rigs.rigs import match_rig
from numpy_cae.mocap.units import guess_unit, require_unit
from numpy_cae.motion.joints import JOINTS, PARENTS
from numpy_cae.motion.motion import Motion

_ENDS = ("knee", "ankle", "elbow", "wrist")
_LIMBS = [f"{side}_{end}" for side in ("left", "right") for end in _ENDS]
LIMBS = 0.77
"""LIMBS: a leg from hip to ankle and an arm from shoulder to wrist are together this part of a
person's stature."""
UPRIGHT = 0.8
"""UPRIGHT: an axis is up if the direction from the ankles to the head, a unit vector, has at least
this component along it in most frames."""
TOE = 0.04
"""TOE: height in metres of the lowest of the twenty joints, a toe, of a person who stands."""
FLOOR = 0.15
"""FLOOR: a floor nearer to 0 than this (m) is not moved, because it cannot be distinguished from
shoes, a rig's toes and uneven ground. In 487 files of CMU and Bandai the level found is -0.12
to 0.12 (docs/lab_book/axes_and_floor.md)."""
STEADY = 0.03
"""STEADY: a body rests on a floor if the quartiles of its lowest joint's height are closer together
than this (m)."""
NEAR = 0.10
"""NEAR: the body stands or lies on a floor if its lowest joint is nearer to it than this (m)."""
AT_ZERO = 0.25
"""AT_ZERO: a body that is near 0 for this part of the time has its floor there, whatever is below
(stairs, a ladder)."""
AT_LEVEL = 0.1
"""AT_LEVEL: else the floor is the lowest level at which the body is for this part of the time."""
_POSES = 500
"""_POSES: about this many poses of a motion are looked at."""


@dataclass(frozen=True)
class Coordinates:
    """What the user knows of the files' coordinates; what is None is detected in each file.

    Parameters
    ----------
    unit : float, optional
        Metres in one unit of length.
    up : str, optional
        The axis that is up, a key of `TO_Y_UP`.
    floor : float, optional
        Height of the floor in the file along that axis, in metres.

    Raises
    ------
    ValueError
        If one is not valid.

    Examples
    --------
    >>> Coordinates(unit=0.01, up="z")  # the height of the floor is detected
    Coordinates(unit=0.01, up='z', floor=None)
    """

    unit: float | None = None
    up: str | None = None
    floor: float | None = None

    def __post_init__(self) -> None:
        if self.unit is not None:
            require_unit(self.unit)
        if self.up is not None and self.up not in TO_Y_UP:
            raise ValueError(f"up is {self.up!r}, expected one of {', '.join(TO_Y_UP)}")
        if self.floor is not None and not np.isfinite(self.floor):
            raise ValueError(f"floor is {self.floor}, expected its height in metres")


def with_unit_of_limbs(motion: Motion) -> Motion:
    """The motion with its unit guessed again, from the twenty joints' legs and arms alone: props,
    hair and fingers do not count. The same motion if they were not found."""
    found = match_rig(motion.skeleton)[1]
    starts = {end: JOINTS[PARENTS[JOINTS.index(end)]] for end in _LIMBS}
    if not {*starts, *starts.values()} <= set(found):
        return motion
    lengths = np.linalg.norm(np.median(sampled(motion).translations, axis=0), axis=-1)
    total = 0.0
    for end, above in starts.items():
        path, start = motion.skeleton.path(found[end]), found[above]
        total += lengths[path[: path.index(start)]].sum() if start in path else 0.0
    unit, note = guess_unit(total / 2 / LIMBS / motion.unit)
    scale = unit / motion.unit
    _, *notes = motion.unit_note.split("; ")
    motion = replace(motion, unit=unit, unit_note="; ".join([note, *notes]))
    if scale == 1:
        return motion
    skeleton, translations = motion.skeleton.scaled(scale), scale * motion.translations
    return replace(motion, skeleton=skeleton, translations=translations)


def detect_up(body: np.ndarray, rest: np.ndarray) -> str:
    """The axis that is up, from positions (F, 20, 3) of the twenty joints in metres.

    `rest` (20, 3) are their positions in the rest pose.
    """
    component, up = _upright(body)
    if abs(component) < UPRIGHT:
        return "y"
    if _rests_at_zero(body, "y") and (
        not _rests_at_zero(body, up) or _upright(rest[None])[1] == "y"
    ):
        return "y"
    return up


def _upright(body: np.ndarray) -> tuple[float, str]:
    """The largest component of the median direction from the ankles to the head, and its axis."""
    ankles = [JOINTS.index("left_ankle"), JOINTS.index("right_ankle")]
    direction = body[:, JOINTS.index("head")] - body[:, ankles].mean(axis=1)
    direction /= np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-9)
    median = np.median(direction, axis=0)
    axis = int(np.argmax(np.abs(median)))
    return float(median[axis]), ("-" if median[axis] < 0 else "") + "xyz"[axis]


def _rests_at_zero(body: np.ndarray, up: str) -> bool:
    """Whether the lowest joint is nearly always at 0, if this axis is up."""
    low = (body @ np.transpose(TO_Y_UP[up]))[..., 1].min(axis=1)
    level, first, third = np.percentile(low, [5, 25, 75])
    return bool(abs(level) < FLOOR and third - first < STEADY)


def detect_floor(body: np.ndarray) -> float:
    """The height of the floor below positions (F, 20, 3), Y up; 0 unless it is clearly another."""
    low = body[..., 1].min(axis=1) - TOE
    level = float(np.percentile(low, 5))
    at_zero = np.mean(np.abs(low) < NEAR) >= AT_ZERO
    is_elsewhere = abs(level) > FLOOR and not at_zero and np.mean(low < level + NEAR) >= AT_LEVEL
    return level if is_elsewhere else 0.0


def in_y_up(motion: Motion, coordinates: Coordinates) -> Motion:
    """The motion as a file has it, turned to Y up and moved to a floor at 0.

    What `coordinates` leaves open is detected; in a rig in which the twenty joints are not found, Y
    is taken to be up and the floor to be at 0.
    """
    up, floor = coordinates.up, coordinates.floor
    reasons = ["as given" if given is not None else "detected" for given in (up, floor)]
    rig_joints = match_rig(motion.skeleton)[1]
    if len(rig_joints) == len(JOINTS) and (up is None or floor is None):
        joints = [rig_joints[joint] for joint in JOINTS]
        body = motion.at(slice(None, None, max(1, len(motion) // _POSES))).positions(joints)
        rest = motion.skeleton.rest_positions()[joints]
        up = detect_up(body, rest) if up is None else up
        floor = detect_floor(body @ np.transpose(TO_Y_UP[up])) if floor is None else floor
    up, floor = up or "y", floor or 0.0
    changes = [f"{up.upper()} up ({reasons[0]})"] if up != "y" else []
    changes += [f"floor at {floor:.2f} m ({reasons[1]})"] if floor else []
    note = "; ".join([motion.unit_note, *changes])
    return replace(to_y_up(motion, up, floor), unit_note=note)
