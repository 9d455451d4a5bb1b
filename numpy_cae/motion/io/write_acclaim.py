"""Write a motion as Acclaim files: a skeleton (.asf) and what it does (.amc), as CMU's database.

The inverse of `read_asf` and `read_amc`. Bones stand along the world's axes here (`axis 0 0 0`),
so that a joint's rotation is written as it is, as angles about fixed axes:

    R = R_z · R_y · R_x        (dof rx ry rz)
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.atomic_write import atomic_write
from numpy_cae.motion.io.amc import CMU_RATE
from numpy_cae.motion.io.units import CMU_UNIT, INCH, require_unit
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.skeleton import Skeleton

_SAME_PLACE = 1e-6
"""Metres. What a bone's tip may differ by among the joints that sit on it."""


def write_acclaim(motion: Motion, path: str | Path, unit: float = CMU_UNIT) -> None:
    """Write a motion to an .amc file and its skeleton to an .asf file of the same name beside it.

    Parameters
    ----------
    motion : Motion
    path : path of the .amc file
    unit : float
        Metres in one unit of length of the files; by default that of the CMU database.

    Raises
    ------
    ValueError
        As `write_asf` and `write_amc` do.
    MotionFileError
        If a file cannot be written.
    """
    path = Path(path)
    write_asf(motion.skeleton, path.with_suffix(".asf"), unit)
    write_amc(motion, path, unit)


def write_asf(skeleton: Skeleton, path: str | Path, unit: float = CMU_UNIT) -> None:
    """Write a skeleton, wholly or not at all.

    Every bone may turn about all three axes. Joints whose parents stand in the file are named for
    the bone that begins at them, as `read_asf` names them; the root must be called "root".

    Parameters
    ----------
    skeleton : Skeleton
    path : path of the .asf file
    unit : float
        Metres in one unit of length of the file.

    Raises
    ------
    ValueError
        If the skeleton cannot be said in Acclaim's words: joints that hang from one bone but sit
        in different places, children of the root away from it, a root of another name, a name
        with blanks or special characters; or if `unit` is not above 0.
    MotionFileError
        If the file cannot be written.
    """
    unit = require_unit(unit)
    tips = _tips(skeleton)
    for name in skeleton.names:
        if not name or any(not c.isprintable() or c in " ,():#" for c in name) or name.isdigit():
            raise ValueError(f"joint name {name!r} cannot be written to an Acclaim file")
    with atomic_write(path) as beside, beside.open("w", encoding="utf-8", newline="\n") as file:
        for line in _asf_lines(skeleton, tips, unit):
            file.write(line + "\n")


def write_amc(motion: Motion, path: str | Path, unit: float = CMU_UNIT) -> None:
    """Write what a skeleton does, wholly or not at all, for the .asf file that `write_asf` makes.

    Reading both back gives positions within 1e-5 m.

    Parameters
    ----------
    motion : Motion
    path : path of the .amc file
    unit : float
        Metres in one unit of length, the same as in the .asf file.

    Raises
    ------
    ValueError
        If the motion has no frames or values that are not finite, a joint other than the root
        leaves its offset (Acclaim bones do not stretch here), or `unit` is not above 0.
    MotionFileError
        If the file cannot be written.
    """
    unit = require_unit(unit)
    _require_stiff(motion)
    with atomic_write(path) as beside, beside.open("w", encoding="utf-8", newline="\n") as file:
        file.write(":FULLY-SPECIFIED\n:DEGREES\n")
        # The format has no rate; readers take the 120 Hz of the CMU database unless told.
        if motion.rate != CMU_RATE:
            file.write(f":SAMPLES-PER-SECOND {motion.rate:.10g}\n")
        for frame in _amc_frames(motion, unit):
            file.write(frame)


def _tips(skeleton: Skeleton) -> np.ndarray:
    """Where each bone ends, from where it begins, (J, 3) in metres."""
    if skeleton.names[0] != "root":
        raise ValueError(
            f"the first joint is called {skeleton.names[0]!r}, expected 'root' as Acclaim has it"
        )
    tips = np.zeros((len(skeleton.names), 3))
    for joint, name in enumerate(skeleton.names):
        children = skeleton.children(joint)
        ends = [skeleton.offsets[child] for child in children]
        if joint in skeleton.end_sites and not children:
            ends.append(skeleton.end_sites[joint])
        if joint == 0:
            ends.append(np.zeros(3))
        for end in ends[1:]:
            if np.abs(end - ends[0]).max() > _SAME_PLACE:
                raise ValueError(
                    f"what hangs from {name!r} sits in different places: an Acclaim bone has one "
                    "end, and the root none away from itself"
                )
        if ends:
            tips[joint] = ends[0]
    return tips


def _asf_lines(skeleton: Skeleton, tips: np.ndarray, unit: float) -> Iterator[str]:
    position = " ".join(f"{value:.9g}" for value in skeleton.offsets[0] / unit)
    yield "# written by numpy_cae"
    yield ":version 1.10"
    yield ":name person"
    yield ":units"
    yield "  mass 1.0"
    yield f"  length {INCH / unit:.12g}"
    yield "  angle deg"
    yield ":root"
    yield "  order TX TY TZ RX RY RZ"
    yield "  axis XYZ"
    yield f"  position {position}"
    yield "  orientation 0 0 0"
    yield ":bonedata"
    for joint, name in enumerate(skeleton.names[1:], start=1):
        length = float(np.linalg.norm(tips[joint]))
        direction = tips[joint] / length if length > 0 else np.array([0.0, 1.0, 0.0])
        yield "  begin"
        yield f"    id {joint}"
        yield f"    name {name}"
        yield "    direction " + " ".join(f"{value:.10f}" for value in direction)
        yield f"    length {length / unit:.10g}"
        yield "    axis 0 0 0 XYZ"
        yield "    dof rx ry rz"
        yield "    limits (-180 180) (-180 180) (-180 180)"
        yield "  end"
    yield ":hierarchy"
    yield "  begin"
    for joint, name in enumerate(skeleton.names):
        children = [skeleton.names[child] for child in skeleton.children(joint)]
        if children:
            yield f"    {name} {' '.join(children)}"
    yield "  end"


def _require_stiff(motion: Motion) -> None:
    if len(motion) == 0:
        raise ValueError("the motion has no frames, expected one at least")
    for what in ("rotations", "translations"):
        wrong = np.argwhere(~np.isfinite(getattr(motion, what)))
        if len(wrong):
            frame, joint, _ = wrong[0]
            raise ValueError(
                f"{what} hold a value that is not finite: frame {frame}, "
                f"joint {motion.skeleton.names[joint]!r}"
            )
    away = np.abs(motion.translations[:, 1:] - motion.skeleton.offsets[1:])
    stretched = np.argwhere(away > _SAME_PLACE)
    if len(stretched):
        frame, joint, _ = stretched[0]
        raise ValueError(
            f"joint {motion.skeleton.names[joint + 1]!r} leaves its offset in frame {frame}: "
            "bones of an Acclaim file neither stretch nor slide; write BVH"
        )


def _amc_frames(motion: Motion, unit: float) -> Iterator[str]:
    place = (motion.translations[:, 0] - motion.skeleton.offsets[0]) / unit
    angles = [_fixed_axis_angles(motion.rotations[:, j]) for j in range(len(motion.skeleton.names))]
    table = np.concatenate([place, *angles], axis=1)
    lines = ["%d", "root %.7f %.7f %.7f %.6f %.6f %.6f"]
    lines += [name.replace("%", "%%") + " %.6f %.6f %.6f" for name in motion.skeleton.names[1:]]
    frame = "\n".join(lines) + "\n"
    for number, values in enumerate(table.tolist(), start=1):
        yield frame % (number, *values)


def _fixed_axis_angles(rotations: np.ndarray) -> np.ndarray:
    """(F, 3) degrees about x, y and z in this order, without leaps of a whole turn."""
    with warnings.catch_warnings():
        # At a pole scipy sets one angle to zero and says so; the rotation is the same.
        warnings.filterwarnings("ignore", message="Gimbal lock")
        angles = Rotation.from_quat(rotations).as_euler("xyz", degrees=True)
    return np.unwrap(angles, axis=0, period=360.0)
