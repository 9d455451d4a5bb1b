"""Write a motion as BVH that reads back the same and opens in Blender.

Blender's importer reads by lines and asks for more than the format does: every brace on a line of
its own, OFFSET right below '{' and CHANNELS right below OFFSET, all three rotations of a joint or
none, and `Frames:` and `Frame Time:` as written here. Its bones end at the next joint, so a last
joint needs an End Site.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.atomic_write import atomic_write
from numpy_cae.motion.io.units import require_unit
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.skeleton import Skeleton

EULER = "ZXY"
"""R = R_z · R_x · R_y, the order that most files have. Its poles lie where the middle angle is at
±90°: a trunk seldom bends that far about X, while a turn about Y, which a person makes all the
way round, meets none. At a pole the angles are not unique, but the rotation they make still is."""

POSITIONS = ["Xposition", "Yposition", "Zposition"]
RESOLUTION = 1e-7
"""Metres. Positions are written to it; a joint that never leaves its offset further has no
position channels."""
ANGLE_DECIMALS = 6
"""1e-6 of a degree moves the end of a 2 m chain by 4e-8 m."""


def write_bvh(motion: Motion, path: str | Path, unit: float | None = None) -> None:
    """Write a motion to a BVH file, wholly or not at all.

    Reading it back gives positions within 1e-5 m. Joints stand depth first in the file, as the
    format has it, whatever their order in the skeleton; the root has six channels, another joint
    three rotations, and three positions before them where it does not stay at its offset.

    Parameters
    ----------
    motion : Motion
    path : path of the file
        Replaced if it is there.
    unit : float, optional
        Metres in one unit of length of the file; `motion.unit` by default.

    Raises
    ------
    ValueError
        If the motion has no frames, values that are not finite or names that BVH cannot hold, or
        `unit` is not above 0.
    FileError
        If the file cannot be written.
    """
    unit = require_unit(motion.unit if unit is None else unit)
    _require_writable(motion)
    order = _depth_first(motion.skeleton)
    moving = {joint for joint in order if joint == 0 or _leaves_its_offset(motion, joint)}
    lines = ["HIERARCHY", *_joint_lines(motion.skeleton, order, moving, unit), "MOTION"]
    lines += [f"Frames: {len(motion)}", f"Frame Time: {1 / motion.rate:.10g}"]
    with atomic_write(path) as beside, beside.open("w", encoding="utf-8", newline="\n") as file:
        for line in lines:
            file.write(line + "\n")
        for line in _frame_lines(motion, order, moving, unit):
            file.write(line + "\n")


def _require_writable(motion: Motion) -> None:
    if len(motion) == 0:
        raise ValueError("the motion has no frames, expected one at least")
    for name in motion.skeleton.names:
        if not name or name != name.strip() or any(c in "{}" or not c.isprintable() for c in name):
            raise ValueError(f"joint name {name!r} cannot be written to a BVH file")
    for what in ("rotations", "translations"):
        wrong = np.argwhere(~np.isfinite(getattr(motion, what)))
        if len(wrong):
            frame, joint, _ = wrong[0]
            raise ValueError(
                f"{what} hold a value that is not finite: frame {frame}, "
                f"joint {motion.skeleton.names[joint]!r}"
            )


def _depth_first(skeleton: Skeleton) -> list[int]:
    order, waiting = [], [0]
    while waiting:
        order.append(waiting.pop())
        waiting += reversed(skeleton.children(order[-1]))
    return order


def _leaves_its_offset(motion: Motion, joint: int) -> bool:
    away = motion.translations[:, joint] - motion.skeleton.offsets[joint]
    return bool(np.abs(away).max() > RESOLUTION)


def _length_format(unit: float) -> str:
    decimals = max(0, int(np.ceil(np.log10(unit / RESOLUTION))))
    return f"%.{decimals}f"


def _joint_lines(
    skeleton: Skeleton, order: list[int], moving: set[int], unit: float
) -> Iterator[str]:
    def offset(vector: np.ndarray) -> str:
        return "OFFSET " + " ".join(_length_format(unit) % value for value in vector / unit)

    rotations = [f"{axis}rotation" for axis in EULER]
    still_open: list[int] = []
    for joint in order:
        while still_open and still_open[-1] != skeleton.parents[joint]:
            still_open.pop()
            yield "  " * len(still_open) + "}"
        outer, inner = "  " * len(still_open), "  " * (len(still_open) + 1)
        still_open.append(joint)
        channels = POSITIONS + rotations if joint in moving else rotations
        yield f"{outer}{'JOINT' if joint else 'ROOT'} {skeleton.names[joint]}"
        yield f"{outer}{{"
        yield f"{inner}{offset(skeleton.offsets[joint])}"
        yield f"{inner}CHANNELS {len(channels)} {' '.join(channels)}"
        if joint in skeleton.end_sites or not skeleton.children(joint):
            yield f"{inner}End Site"
            yield f"{inner}{{"
            yield f"{inner}  {offset(skeleton.end_sites.get(joint, np.zeros(3)))}"
            yield f"{inner}}}"
    while still_open:
        still_open.pop()
        yield "  " * len(still_open) + "}"


def _frame_lines(motion: Motion, order: list[int], moving: set[int], unit: float) -> Iterator[str]:
    columns, formats = [], []
    for joint in order:
        if joint in moving:
            columns.append(motion.translations[:, joint] / unit)
            formats += [_length_format(unit)] * 3
        columns.append(_euler_angles(motion.rotations[:, joint]))
        formats += [f"%.{ANGLE_DECIMALS}f"] * 3
    line = " ".join(formats)
    for values in np.concatenate(columns, axis=1).tolist():
        yield line % tuple(values)


def _euler_angles(rotations: np.ndarray) -> np.ndarray:
    """(F, 3) degrees, without leaps of a whole turn between frames."""
    with warnings.catch_warnings():
        # At a pole scipy sets one angle to zero and says so; the rotation is the same.
        warnings.filterwarnings("ignore", message="Gimbal lock")
        angles = Rotation.from_quat(rotations).as_euler(EULER, degrees=True)
    return np.unwrap(angles, axis=0, period=360.0)
