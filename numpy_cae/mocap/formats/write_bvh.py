"""Write a motion as a new BVH file (`rewrite_numbers` keeps the text of the file it came from).

The file opens in Blender, and `read_bvh` reads the same motion from it. Blender's importer reads
line by line and requires more than the format does: every brace on a line of its own, OFFSET
directly below '{' and CHANNELS directly below OFFSET, all three rotations of a joint or none, and
`Frames:` and `Frame Time:` as written here. Its bones end at the next joint, so the last joint of
a limb needs an End Site.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.mocap.coordinates import turn_as_in_file
from numpy_cae.mocap.formats.text_file import MAX_JOINTS, MAX_VALUE
from numpy_cae.mocap.units import require_unit
from numpy_cae.motion import Motion, Skeleton
from numpy_cae.motion.motion import MAX_RATE, MIN_RATE, depth_first, require_finite
from numpy_cae.motion.quaternions import continuous_angles, nearest_angles

POSITIONS = ["Xposition", "Yposition", "Zposition"]
ROTATIONS = ["Zrotation", "Xrotation", "Yrotation"]
"""R = R_z · R_x · R_y, as in most files. The angles are not unique at the poles of this order,
where the middle angle is ±90°, but their rotation still is. A trunk seldom bends that far about X,
and a full turn about Y meets no pole."""
RESOLUTION = 1e-7
"""Positions in the file are rounded to this (m). A joint that is never further from its offset has
no position channels."""
ANGLE_FORMAT = "%.6f"
"""Degrees have six decimals: an error of 1e-6 degrees moves the end of a chain of 2 m by 4e-8 m."""


def write_bvh(motion: Motion, path: str | Path, unit: float | None = None) -> None:
    """Write a motion to a BVH file atomically.

    The up axis and the floor are those of the file that the motion came from. When the new file is
    read, positions are within 1e-5 m. Joints are in depth-first order, whatever their order in the
    skeleton. The root has six channels; another joint has three rotations and, if it leaves its
    offset, three positions before them.

    Parameters
    ----------
    motion : Motion
    path : path of the file
        Replaced if it exists.
    unit : float, optional
        Metres in one unit of length of the file; `motion.unit` by default.

    Raises
    ------
    ValueError
        If the motion has no frames, values that are not finite or names that BVH cannot hold, or
        `unit` is no length that a file can have.
    FileError
        If the file cannot be written.

    Examples
    --------
    >>> from data_synth import make_take
    >>> write_bvh(make_take("walk", 1, seconds=1.0, rate=30.0).motion, "walk.bvh")
    >>> Path("walk.bvh").read_text().splitlines()[:2]
    ['HIERARCHY', 'ROOT root']
    """
    require_bvh(path)
    unit = require_unit(motion.unit if unit is None else unit)
    motion = turn_as_in_file(motion)
    require_finite(motion)
    _require_readable(motion, unit)
    joints = range(len(motion.skeleton.names))
    order = depth_first(0, {joint: motion.skeleton.children(joint) for joint in joints})
    distance = np.abs(motion.translations - motion.skeleton.offsets).max(axis=0).max(axis=1)
    moving = {joint for joint in order if joint == 0 or distance[joint] > RESOLUTION}
    lines = ["HIERARCHY", *_joint_lines(motion.skeleton, order, moving, unit), "MOTION"]
    lines += [f"Frames: {len(motion)}", f"Frame Time: {1 / motion.rate:.10g}"]
    with atomic_write(path) as temp, temp.open("w", encoding="utf-8", newline="\n") as file:
        file.write("\n".join(lines) + "\n")
        values, formats = _table(motion, order, moving, unit)
        _write_rows(file, values, formats)


def _write_rows(file: TextIO, values: np.ndarray, formats: list[str]) -> None:
    """Write the numbers of each frame as a line, as `np.savetxt` does, which takes longer."""
    row_format = " ".join(formats) + "\n"
    file.writelines(row_format % tuple(row.tolist()) for row in values)


def _require_readable(motion: Motion, unit: float) -> None:
    """Raise ValueError for what `read_bvh` would refuse in the file."""
    names = motion.skeleton.names
    for name in names:
        if not name or name != name.strip() or any(c in "{}" or not c.isprintable() for c in name):
            raise ValueError(f"joint name {name!r} cannot be written to a BVH file")
    if len({name.rsplit(":", 1)[-1] for name in names}) < len(names) or len(names) > MAX_JOINTS:
        problem = f"expected at most {MAX_JOINTS}, unique without a prefix up to a colon"
        raise ValueError(f"the {len(names)} joint names cannot be written to a BVH file, {problem}")
    if not MIN_RATE <= motion.rate <= MAX_RATE:
        raise ValueError(f"rate is {motion.rate:g}, expected {MIN_RATE:g} to {MAX_RATE:g}")
    tips = motion.skeleton.end_sites.values()
    largest = max(np.abs(x).max() for x in (motion.translations, motion.skeleton.offsets, *tips))
    if largest / unit >= MAX_VALUE:
        raise ValueError(f"a length is {largest:g} m, expected less than {MAX_VALUE * unit:g} m")


def _length_format(unit: float) -> str:
    decimals = max(0, int(np.ceil(np.log10(unit / RESOLUTION))))
    return f"%.{decimals}f"


def _joint_lines(
    skeleton: Skeleton, order: list[int], moving: set[int], unit: float
) -> Iterator[str]:
    def offset(vector: np.ndarray) -> str:
        return "OFFSET " + " ".join(_length_format(unit) % value for value in vector / unit)

    depths = [len(skeleton.path(joint)) - 1 for joint in order]
    for joint, depth, next_depth in zip(order, depths, [*depths[1:], 0], strict=True):
        channels = POSITIONS + ROTATIONS if joint in moving else ROTATIONS
        lines = [
            f"{'JOINT' if joint else 'ROOT'} {skeleton.names[joint]}",
            "{",
            f"  {offset(skeleton.offsets[joint])}",
            f"  CHANNELS {len(channels)} {' '.join(channels)}",
        ]
        if joint in skeleton.end_sites or not skeleton.children(joint):
            tip = offset(skeleton.end_sites.get(joint, np.zeros(3)))
            lines += ["  End Site", "  {", f"    {tip}", "  }"]
        yield from ("  " * depth + line for line in lines)
        yield from ("  " * level + "}" for level in range(depth, next_depth - 1, -1))


def _table(
    motion: Motion, order: list[int], moving: set[int], unit: float
) -> tuple[np.ndarray, list[str]]:
    """The numbers of each frame, and the format of each column."""
    columns: list[np.ndarray] = []
    formats: list[str] = []
    for joint in order:
        if joint in moving:
            columns.append(motion.translations[:, joint] / unit)
            formats += [_length_format(unit)] * 3
        # Many angles give the same rotation: these have no avoidable jumps between frames.
        angles = continuous_angles(nearest_angles(motion.rotations[:, joint], "ZXY"))
        columns.append(np.degrees(angles))
        formats += [ANGLE_FORMAT] * 3
    return np.concatenate(columns, axis=1), formats


def require_bvh(path: str | Path) -> None:
    """Raise ValueError unless a file of this name is a BVH file."""
    if Path(path).suffix.lower() != ".bvh":
        raise ValueError(f"{path}: a motion is written as .bvh")
