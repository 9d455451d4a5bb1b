"""The up axis and the floor of a motion file: detected, changed to Y up and 0, and restored.

A `Motion` is Y up with the floor at 0, and may have joints that its file lacks. `Motion.up`,
`Motion.floor` and `Rig.added` say how the file has it, and the writers restore that.

Nearly all files have Y up and the floor at 0; such files pass through unchanged. Three observations
decide, on the twenty joints:

- Upright: the median direction from the ankles to the head. People stand, walk and sit upright; if
  it is along another axis, that axis is up, unless the body rests on the floor at Y = 0, as someone
  who does press-ups or lies. A body whose head is below its feet in most frames hangs: -Y is up.
- The rest pose: people may lie, crawl and fall. So where the rest pose has another axis up, that
  axis is up if they stand along it in some frames, or if they move over a floor across it; unless
  they move over a floor along it, since some rigs have a rest pose in which nobody stands.
- Support: the lowest joint is near the floor most of the time. If the lowest level at which it
  stays is far from 0, and it is seldom near 0, the floor is there.
"""

from dataclasses import replace
from typing import TypeVar

import numpy as np

from numpy_cae.mocap.rigs.rigs import RiggedMotion, partial_rig_of
from numpy_cae.mocap.units import require_unit
from numpy_cae.motion import JOINTS, Motion, Note
from numpy_cae.motion.quaternions import nearest, product

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
UPRIGHT_COSINE = 0.8
"""An axis is up if the direction from the ankles to the head, a unit vector, has at least this
component along it in most frames."""
STANDING_SHARE = 0.05
"""A body that is upright along the axis of its rest pose for this part of the time stands then, and
lies in the rest."""
CRAWLING_METRES = 0.5
"""A body that moves by more than this (m) along the direction from the ankles to the head crawls,
unless its height above the floor of the rest pose changes as much."""
TOE_METRES = 0.04
"""Height in metres of the lowest of the twenty joints, a toe, of a person who stands."""
FLOOR_METRES = 0.15
"""A floor nearer to 0 than this (m) is not moved, because it cannot be distinguished from shoes, a
rig's toes and uneven ground. In 487 files of CMU and Bandai the level found is -0.12 to 0.12
(docs/lab_book/features.md)."""
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


HIGHEST_FLOOR = 10_000.0
"""A floor that a user states is at most so high or so low (m), as high as mountains are."""


def require_coordinates(unit: float | None, up: str | None, floor: float | None) -> None:
    """Raise ValueError for a unit in metres, an up axis or a height of the floor in metres that a
    file cannot have; what is None is detected in each file."""
    if unit is not None:
        require_unit(unit)
    if up is not None and up not in TO_Y_UP:
        raise ValueError(f"up is {up!r}, expected one of {', '.join(TO_Y_UP)}")
    if floor is not None and not abs(floor) <= HIGHEST_FLOOR:
        expected = f"expected its height in metres, at most {HIGHEST_FLOOR:g} up or down"
        raise ValueError(f"floor is {floor:g}, {expected}")


def detect_up(body: np.ndarray, rest: np.ndarray) -> str:
    """The axis that is up, from positions (F, 20, 3) of the twenty joints in metres.

    `rest` (20, 3) are their positions in the rest pose.
    """
    component, up = _upright(body)
    if abs(component) < UPRIGHT_COSINE:
        return "y"
    if not _rests_at_zero(body, up):
        for axis in TO_Y_UP:
            if axis != up and _stands_along(body, axis) and _rests_at_zero(body, axis):
                return axis
    of_rest, up_of_rest = _upright(rest[None])
    is_other = abs(of_rest) >= UPRIGHT_COSINE and up_of_rest != up
    if is_other and not _moves_over_floor(body, up, up_of_rest):
        if _stands_along(body, up_of_rest) or _moves_over_floor(body, up_of_rest, up):
            return up_of_rest
    doubtful = not _rests_at_zero(body, up) or up_of_rest == "y"
    return "y" if doubtful and _rests_at_zero(body, "y") else up


def _stands_along(body: np.ndarray, axis: str) -> bool:
    """Whether the body stands along an axis in some frames, as before it falls."""
    heights = _directions(body) @ np.array(TO_Y_UP[axis][1], dtype=float)
    return bool(np.mean(heights >= UPRIGHT_COSINE) >= STANDING_SHARE)


def _moves_over_floor(body: np.ndarray, up: str, along: str) -> bool:
    """Whether the body keeps to a floor at 0, if the axis `up` is up, and moves along the axis
    `along`, as someone who crawls does; a person who stands along that axis does not."""
    low = _lowest(body, up)
    level, highest = np.percentile(low, [5, 95])
    way = np.ptp(np.percentile(_lowest(body, along), [5, 95]))
    keeps = abs(level) < FLOOR_METRES and highest - level < FLOOR_METRES
    return bool(keeps and way > CRAWLING_METRES)


def _lowest(body: np.ndarray, up: str) -> np.ndarray:
    """The height (F,) of the lowest joint if the axis `up` is up."""
    return np.asarray((body @ np.transpose(TO_Y_UP[up]))[..., 1].min(axis=1))


def _directions(body: np.ndarray) -> np.ndarray:
    """The directions (F, 3) from the ankles to the head, unit vectors."""
    ankles = [JOINTS.index("left_ankle"), JOINTS.index("right_ankle")]
    direction = body[:, JOINTS.index("head")] - body[:, ankles].mean(axis=1)
    return np.asarray(
        direction / np.maximum(np.linalg.norm(direction, axis=1, keepdims=True), 1e-9)
    )


def _upright(body: np.ndarray) -> tuple[float, str]:
    """The largest component of the median direction from the ankles to the head, and its axis."""
    median = np.median(_directions(body), axis=0)
    axis = int(np.argmax(np.abs(median)))
    sign = "-" if median[axis] < 0 else ""
    return float(median[axis]), sign + "xyz"[axis]


def _rests_at_zero(body: np.ndarray, up: str) -> bool:
    """Whether the lowest joint is nearly always at 0, if this axis is up."""
    low = _lowest(body, up)
    level, first, third = np.percentile(low, [5, 25, 75])
    return bool(abs(level) < FLOOR_METRES and third - first < STEADY_METRES)


def detect_floor(body: np.ndarray) -> float:
    """The height of the floor below positions (F, 20, 3), Y up; 0 unless it is clearly another."""
    low = body[..., 1].min(axis=1) - TOE_METRES
    level = float(np.percentile(low, 5))
    at_zero = np.mean(np.abs(low) < NEAR_METRES) >= AT_ZERO_SHARE
    stays = np.mean(low < level + NEAR_METRES) >= AT_LEVEL_SHARE
    return level if abs(level) > FLOOR_METRES and stays and not at_zero else 0.0


def turn_y_up(
    motion: AnyMotion, stated_up: str | None = None, stated_floor: float | None = None
) -> AnyMotion:
    """The motion as a file has it, turned to Y up and moved to a floor at 0; `turn_as_in_file` is
    the inverse.

    What the user does not state is detected; in a rig in which the twenty joints are not found, Y
    is taken to be up and the floor to be at 0.
    """
    up = stated_up or "y"
    floor = stated_floor or 0.0
    rig = partial_rig_of(motion)
    source = "as given"
    if len(rig.indices) == len(JOINTS) and None in (stated_up, stated_floor):
        body = motion.sampled(_POSES).positions(rig.joints)
        rest = motion.skeleton.rest_positions()[rig.joints]
        up = stated_up or detect_up(body, rest)
        source = _source_of_up(stated_up, up, rest)
        if stated_floor is None:
            floor = detect_floor(body @ np.transpose(TO_Y_UP[up]))
    if up == "y" and floor == 0:
        return motion
    notes = list(motion.notes)
    if up != "y":
        notes.append(Note("up", f"{up.upper()} up ({source})"))
    if floor != 0:
        notes.append(Note("floor", f"floor at {floor:.2f} m ({_source(stated_floor)})"))
    turned = _turn(motion, np.array(TO_Y_UP[up], dtype=float))
    turned.translations[:, 0, 1] -= floor
    return replace(turned, up=up, floor=floor, notes=tuple(notes))


def _source(stated: float | None) -> str:
    """How a note calls the source of what the user stated, or did not."""
    return "detected" if stated is None else "as given"


def _source_of_up(stated: str | None, up: str, rest: np.ndarray) -> str:
    """How a note calls the source of the up axis; a person who lies may look like one who stands,
    so what contradicts the rest pose (20, 3) is said to be in doubt."""
    if stated is not None:
        return "as given"
    component, up_of_rest = _upright(rest[None])
    if abs(component) < UPRIGHT_COSINE or up_of_rest == up:
        return "detected"
    return f"detected; the rest pose has {up_of_rest.upper()} up: --up {up_of_rest} if people lie"


def turn_as_in_file(motion: Motion) -> Motion:
    """The motion in the axes, at the height and with the joints of its file, for a writer."""
    motion = _drop_added_joints(motion)
    if motion.up == "y" and motion.floor == 0:
        return motion
    translations = motion.translations.copy()
    translations[:, 0, 1] += motion.floor
    moved = replace(motion, translations=translations, up="y", floor=0.0)
    return _turn(moved, np.array(TO_Y_UP[motion.up], dtype=float).T)


def _turn(motion: AnyMotion, matrix: np.ndarray) -> AnyMotion:
    """The motion with its root turned."""
    rotations = motion.rotations.copy()
    rotations[:, 0] = product(nearest(matrix), rotations[:, 0])
    translations = motion.translations.copy()
    translations[:, 0] = translations[:, 0] @ matrix.T
    return replace(motion, rotations=rotations, translations=translations)


def _drop_added_joints(motion: Motion) -> Motion:
    """The motion of the joints that the file has."""
    if not isinstance(motion, RiggedMotion) or not motion.rig.added:
        return motion
    count = motion.rig.added[0]  # the joints that the file lacks are the last ones
    skeleton = replace(
        motion.skeleton,
        names=motion.skeleton.names[:count],
        parents=motion.skeleton.parents[:count],
        offsets=motion.skeleton.offsets[:count],
    )
    return replace(
        motion,
        skeleton=skeleton,
        rotations=motion.rotations[:, :count],
        translations=motion.translations[:, :count],
    )
