"""The up axis and the floor of a motion file: detected, changed to Y up and 0, and restored.

A `Motion` is Y up with the floor at 0, and may have joints that its file lacks. `Motion.up`,
`Motion.floor` and `Rig.added` say how the file has it, and the writers restore that.

Nearly all files have Y up and the floor at 0; such files pass through unchanged. Two observations
decide, on the twenty joints:

- Upright: the median direction from the ankles to the head. People stand, walk and sit upright; if
  it is along another axis, that axis is up, unless the body rests on the floor at Y = 0, as someone
  who does press-ups or lies. A body whose head is below its feet in most frames hangs: -Y is up.
- Support: the lowest joint is near the floor most of the time. If the lowest level at which it
  stays is far from 0, and it is seldom near 0, the floor is there.

The unit of length of a motion file.

BVH does not state it. The people in motion capture are adults, so the size of the skeleton tells:
a person some 172 units tall is in centimetres. The stature is derived from the lengths of the
bones alone, since a rest pose may be anything (Bandai's has every bone along x) and a root may lie
on the floor. The longest path along bones from one tip to another runs from a toe to the finger
tips; it is about 1.3 times the stature in any pose (less in a rig that ends at the wrists, as
Bandai's, more with fingers, as in CMU's).
"""

from dataclasses import replace
from typing import TypeVar

import numpy as np

from numpy_cae.mocap.rigs.rigs import RiggedMotion, own_rig
from numpy_cae.motion import JOINTS, PARENTS, Motion, Note, Skeleton
from numpy_cae.motion.quaternions import nearest, product

INCH = 0.0254
# CMU's skeletons say `length 0.45`: a value divided by 0.45 is inches.
CMU_UNIT = INCH / 0.45
UNITS = {
    "metres": 1.0,
    "decimetres": 0.1,
    "CMU's units of 1/0.45 inch": CMU_UNIT,
    "inches": INCH,
    "centimetres": 0.01,
    "millimetres": 0.001,
}
"""The candidates of a guess, in metres. Feet are not among them: no file uses them."""

TYPICAL_METRES = 1.55
"""The stature (m) to which a guess comes closest, the geometric mean of 1.1 m (a child of five) and
2.2 m (nobody is taller)."""
TIP_TO_TIP_STATURES = 1.3
"""The way from a toe to the finger tips along the bones, in statures."""
PLAUSIBLE_METRES = (0.9, 2.4)
"""A guess that gives a stature (m) outside this range is not reliable."""


def require_unit(unit: float) -> float:
    """The unit; ValueError unless it is a positive number of metres."""
    if not (np.isfinite(unit) and unit > 0):
        raise ValueError(f"unit is {unit}, expected metres per unit of the file, above 0")
    return float(unit)


def unit_name(unit: float) -> str:
    """The name of a unit that is this many metres long."""
    names = (name for name, metres in UNITS.items() if abs(unit / metres - 1) < 1e-6)
    return next(names, f"units of {unit:g} m")


def stature(skeleton: Skeleton, bone_lengths: np.ndarray) -> float:
    """The stature of a person with bones of these lengths (J,), from each joint to its parent, in
    the unit of the lengths; 0 without two tips."""
    longest = 0.0
    # The longest path down from each joint to a tip. A path from tip to tip goes up to some joint
    # and down again; a root without branches is never such a joint.
    reach = np.full(len(skeleton.names), -np.inf)
    for joint, tip in skeleton.end_sites.items():
        reach[joint] = np.linalg.norm(tip)
    for joint in range(len(reach) - 1, 0, -1):
        parent = skeleton.parents[joint]
        length = bone_lengths[joint] + max(reach[joint], 0.0)
        longest = max(longest, float(reach[parent] + length))
        reach[parent] = max(reach[parent], length)
    return longest / TIP_TO_TIP_STATURES


def stated_unit(unit: float, source: str, height: float) -> Note:
    """A note on a unit and its source, from the height of the person (m, 0 if unknown). The unit is
    in doubt if nobody is as tall."""
    in_doubt = height > 0 and not PLAUSIBLE_METRES[0] <= height <= PLAUSIBLE_METRES[1]
    advice = ", which no adult is: give the right unit" if in_doubt else ""
    text = f"{unit_name(unit)} ({source}: the skeleton is about {height:.1f} m tall{advice})"
    return Note("unit", text, in_doubt)


def guess_unit(height: float) -> tuple[float, Note]:
    """The unit in metres in which a person of this height is closest to `TYPICAL_METRES`, and a
    note."""
    if not height > 0:
        text = "metres (assumed: the skeleton has no two limbs to measure)"
        return 1.0, Note("unit", text)
    unit = min(UNITS.values(), key=lambda unit: abs(np.log(height * unit / TYPICAL_METRES)))
    return unit, stated_unit(unit, "guessed", height * unit)


TO_Y_UP = {
    "y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "x": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "-y": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "-z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-x": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
}
"""The rotation that takes a file whose up axis is this one to Y up, as rows of a matrix."""
AnyMotion = TypeVar("AnyMotion", bound=Motion)
_ENDS = ("knee", "ankle", "elbow", "wrist")
_LIMBS = [f"{side}_{end}" for side in ("left", "right") for end in _ENDS]
LIMBS_SHARE = 0.77
"""A leg from hip to ankle and an arm from shoulder to wrist are together this part of a person's
stature."""
UPRIGHT_COSINE = 0.8
"""An axis is up if the direction from the ankles to the head, a unit vector, has at least this
component along it in most frames."""
TOE_METRES = 0.04
"""Height in metres of the lowest of the twenty joints, a toe, of a person who stands."""
FLOOR_METRES = 0.15
"""A floor nearer to 0 than this (m) is not moved, because it cannot be distinguished from shoes, a
rig's toes and uneven ground. In 487 files of CMU and Bandai the level found is -0.12 to 0.12
(docs/lab_book/axes_and_floor.md)."""
STEADY_METRES = 0.03
"""A body rests on a floor if the quartiles of its lowest joint's height are closer together than
this (m)."""
NEAR_METRES = 0.10
"""The body stands or lies on a floor if its lowest joint is nearer to it than this (m)."""
AT_ZERO_SHARE = 0.25
"""A body that is near 0 for this part of the time has its floor there, whatever is below (stairs, a
ladder)."""
AT_LEVEL_SHARE = 0.1
"""Where a body is not near 0 so often, the floor is the lowest level at which it is for this part
of the time."""
_POSES = 500
"""The up axis and the floor are detected in about this many poses of a motion."""
_POSES_OF_BONES = 100
"""Bones are measured in about this many poses of a motion."""


def require_coordinates(unit: float | None, up: str | None, floor: float | None) -> None:
    """Raise ValueError for a unit in metres, an up axis or a height of the floor in metres that a
    file cannot have; what is None is detected in each file."""
    if unit is not None:
        require_unit(unit)
    if up is not None and up not in TO_Y_UP:
        raise ValueError(f"up is {up!r}, expected one of {', '.join(TO_Y_UP)}")
    if floor is not None and not np.isfinite(floor):
        raise ValueError(f"floor is {floor}, expected its height in metres")


def with_unit_of_limbs(motion: RiggedMotion) -> RiggedMotion:
    """The motion with its unit guessed again, from the twenty joints' legs and arms alone: props,
    hair and fingers do not count. The same motion if they were not found."""
    found = motion.rig.found
    starts = {end: JOINTS[PARENTS[JOINTS.index(end)]] for end in _LIMBS}
    if not {*starts, *starts.values()} <= set(found):
        return motion
    translations = motion.sampled(_POSES_OF_BONES).translations
    lengths = np.linalg.norm(np.median(translations, axis=0), axis=-1)
    total = 0.0
    for end, above in starts.items():
        path = motion.skeleton.path(found[end])
        if found[above] in path:
            total += lengths[path[: path.index(found[above])]].sum()
    unit, note = guess_unit(total / 2 / LIMBS_SHARE / motion.unit)
    scale = unit / motion.unit
    motion = replace(motion, unit=unit, notes=(note, *motion.notes[1:]))
    if scale == 1:
        return motion
    skeleton = motion.skeleton.scaled(scale)
    return replace(motion, skeleton=skeleton, translations=scale * motion.translations)


def detect_up(body: np.ndarray, rest: np.ndarray) -> str:
    """The axis that is up, from positions (F, 20, 3) of the twenty joints in metres.

    `rest` (20, 3) are their positions in the rest pose.
    """
    component, up = _upright(body)
    if abs(component) < UPRIGHT_COSINE:
        return "y"
    doubtful = not _rests_at_zero(body, up) or _upright(rest[None])[1] == "y"
    return "y" if doubtful and _rests_at_zero(body, "y") else up


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
    return bool(abs(level) < FLOOR_METRES and third - first < STEADY_METRES)


def detect_floor(body: np.ndarray) -> float:
    """The height of the floor below positions (F, 20, 3), Y up; 0 unless it is clearly another."""
    low = body[..., 1].min(axis=1) - TOE_METRES
    level = float(np.percentile(low, 5))
    at_zero = np.mean(np.abs(low) < NEAR_METRES) >= AT_ZERO_SHARE
    stays = np.mean(low < level + NEAR_METRES) >= AT_LEVEL_SHARE
    return level if abs(level) > FLOOR_METRES and stays and not at_zero else 0.0


def in_y_up(
    motion: AnyMotion, given_up: str | None = None, given_floor: float | None = None
) -> AnyMotion:
    """The motion as a file has it, turned to Y up and moved to a floor at 0; `as_in_file` is the
    inverse.

    What is not given is detected; in a rig in which the twenty joints are not found, Y is taken to
    be up and the floor to be at 0.
    """
    up = given_up or "y"
    floor = given_floor or 0.0
    rig = own_rig(motion)
    if len(rig.found) == len(JOINTS) and None in (given_up, given_floor):
        body = motion.sampled(_POSES).positions(rig.joints)
        up = given_up or detect_up(body, motion.skeleton.rest_positions()[rig.joints])
        if given_floor is None:
            floor = detect_floor(body @ np.transpose(TO_Y_UP[up]))
    if up == "y" and floor == 0:
        return motion
    reasons = ["detected" if given is None else "as given" for given in (given_up, given_floor)]
    notes = [Note("up", f"{up.upper()} up ({reasons[0]})")] * (up != "y")
    notes += [Note("floor", f"floor at {floor:.2f} m ({reasons[1]})")] * (floor != 0)
    turned = _turned(motion, np.array(TO_Y_UP[up], dtype=float))
    turned.translations[:, 0, 1] -= floor
    return replace(turned, up=up, floor=floor, notes=(*motion.notes, *notes))


def as_in_file(motion: Motion) -> Motion:
    """The motion in the axes, at the height and with the joints of its file, for a writer."""
    motion = _without_added(motion)
    if motion.up == "y" and motion.floor == 0:
        return motion
    translations = motion.translations.copy()
    translations[:, 0, 1] += motion.floor
    moved = replace(motion, translations=translations, up="y", floor=0.0)
    return _turned(moved, np.array(TO_Y_UP[motion.up], dtype=float).T)


def _turned(motion: AnyMotion, matrix: np.ndarray) -> AnyMotion:
    """The motion with its root turned."""
    rotations = motion.rotations.copy()
    rotations[:, 0] = product(nearest(matrix), rotations[:, 0])
    translations = motion.translations.copy()
    translations[:, 0] = translations[:, 0] @ matrix.T
    return replace(motion, rotations=rotations, translations=translations)


def _without_added(motion: Motion) -> Motion:
    """The motion of the joints that the file has."""
    if not isinstance(motion, RiggedMotion) or not motion.rig.added:
        return motion
    kept = slice(motion.rig.added[0])  # the joints that the file lacks are the last ones
    whole = motion.skeleton
    parts = {part: getattr(whole, part)[kept] for part in ("names", "parents", "offsets")}
    arrays = {part: getattr(motion, part)[:, kept] for part in ("rotations", "translations")}
    return replace(motion, skeleton=replace(whole, **parts), **arrays)
