"""Read a BVH file: a hierarchy of joints, then one line of channel values for every frame.

Meredith and Maddock, Motion Capture File Formats Explained (2001). What the format leaves open
is taken as most programs do: rotations are about the joint's own axes in the order
of its channels; a position channel stands in the place of the joint's offset, on any joint.
"""

from __future__ import annotations

import logging
import re
from pathlib import Path

import numpy as np

from numpy_cae.motion.io.bvh_hierarchy import BvhJoint, read_hierarchy
from numpy_cae.motion.io.text_file import SLOWEST, TextFile, shortened, whole_number
from numpy_cae.motion.io.units import guess_unit, is_plausible, require_unit, stature, unit_name
from numpy_cae.motion.motion import Motion, whole_step
from numpy_cae.motion.quaternions import IDENTITY, from_euler
from numpy_cae.motion.skeleton import Skeleton

log = logging.getLogger(__name__)


def read_bvh(path: str | Path, unit: float | None = None, wanted: float | None = None) -> Motion:
    """Read a BVH file.

    Parameters
    ----------
    path : path of the file
    unit : float, optional
        Metres in one unit of length of the file: 0.01 where it is in centimetres. By default
        guessed from the size of the skeleton; `Motion.unit_note` and the log say what was taken.
    wanted : float, optional
        Frames a second that are enough. Where leaving frames out makes them, the others are
        counted and not parsed, and the motion has this rate.

    Returns
    -------
    Motion
        In metres, its joints in the order of the file.

    Raises
    ------
    MotionFileError
        If the file is damaged anywhere: never is a motion shortened or filled.
    ValueError
        If `unit` is not above 0.
    """
    if unit is not None:
        unit = require_unit(unit)
    joints, rate, values = read_bvh_channels(path, wanted)
    rotations, translations = _pose(joints, values)

    if unit is None:
        height = stature(_skeleton(joints, 1.0), _lengths(joints, translations))
        unit, note = guess_unit(height)
        log.log(
            logging.INFO if is_plausible(unit * height) else logging.WARNING,
            "%s: lengths taken as %s",
            path,
            note,
        )
    else:
        note = f"{unit_name(unit)}, as given"
    translations *= unit
    return Motion(_skeleton(joints, unit), rate, rotations, translations, unit, note)


def read_bvh_channels(
    path: str | Path, wanted: float | None = None
) -> tuple[list[BvhJoint], float, np.ndarray]:
    """What a BVH file says, as it says it: the numbers that `read_bvh` makes a motion of.

    Returns
    -------
    joints : list of BvhJoint
    rate : float
        Frames a second.
    values : (frames, channels) array of float64
        In the unit of the file and in degrees.

    Raises
    ------
    MotionFileError
        As `read_bvh` does.
    """
    file = TextFile.read(path)
    joints, motion_line = read_hierarchy(file)
    return joints, *_read_motion(file, motion_line, joints, wanted)


def _skeleton(joints: list[BvhJoint], unit: float) -> Skeleton:
    return Skeleton(
        names=tuple(joint.name for joint in joints),
        parents=tuple(joint.parent for joint in joints),
        offsets=unit * np.array([joint.offset for joint in joints]),
        end_sites={
            index: unit * np.array(joint.tip)
            for index, joint in enumerate(joints)
            if joint.tip is not None
        },
    )


def _lengths(joints: list[BvhJoint], translations: np.ndarray) -> np.ndarray:
    """Of the bones as they are in the motion: where there are position channels offsets may lie."""
    lengths = np.linalg.norm(translations[0], axis=-1)
    for index, joint in enumerate(joints):
        if any(channel.endswith("position") for channel in joint.channels or []):
            lengths[index] = np.median(np.linalg.norm(translations[:, index], axis=-1))
    return lengths


def _pose(joints: list[BvhJoint], values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions (F, J, 4) and translations (F, J, 3) from the table of channels (F, C)."""
    frames = len(values)
    values = np.ascontiguousarray(values.T)  # a channel's numbers side by side
    rotations = np.empty((frames, len(joints), 4))
    translations = np.tile([joint.offset for joint in joints], (frames, 1, 1))
    column = 0
    for index, joint in enumerate(joints):
        axes, columns = "", []
        for channel in joint.channels or []:
            if channel.endswith("position"):
                translations[:, index, "XYZ".index(channel[0])] = values[column]
            else:
                axes += channel[0]
                columns.append(column)
            column += 1
        if axes:
            # Capital letters turn about the joint's own axes: R = R_first · R_second · R_third.
            rotations[:, index] = from_euler(axes, values[columns].T)
        else:
            rotations[:, index] = IDENTITY
    return rotations, translations


def _read_motion(
    file: TextFile, motion_line: int, joints: list[BvhJoint], wanted: float | None
) -> tuple[float, np.ndarray]:
    """Frames a second and the table (frames, channels) below MOTION."""
    channels = sum(len(joint.channels or []) for joint in joints)
    count_line, promised = _header(file, motion_line, r"frames\s*:?\s*(.*)", "Frames: and a number")
    time_line, time = _header(
        file, count_line, r"frame\s*time\s*:?\s*(.*)", "Frame Time: and seconds"
    )
    if not whole_number(promised):
        raise file.error(
            count_line, f"Frames: {shortened(promised)}, expected a whole number above 0"
        )
    rate = _rate(file, time_line, time)
    if channels == 0:
        raise file.error(motion_line, "no joint has CHANNELS, so there is no motion to read")

    step = 1 if wanted is None else max(1, whole_step(rate, wanted))
    values, lines = file.table(
        time_line,
        channels,
        "one line a frame, one value for each channel of the hierarchy",
        step,
    )
    if lines != whole_number(promised):
        raise file.error(count_line, f"Frames: says {promised}, but {lines} lines of values follow")
    file.require_meaning(len(values), len(joints))
    return (wanted if step > 1 else rate), values


def _header(file: TextFile, after: int, pattern: str, wanted: str) -> tuple[int, str]:
    """The next line that is not blank, its number and what the pattern finds in it."""
    line, text = next(
        ((line, text) for line, text in file.numbered(after) if text.strip()), (file.count, None)
    )
    if text is None:
        raise file.error(line, f"the file ends below MOTION, expected {wanted}")
    match = re.fullmatch(pattern, text.strip(), re.IGNORECASE)
    if match is None:
        raise file.error(line, f"expected {wanted}, found {shortened(text.strip())}")
    return line, match[1]


def _rate(file: TextFile, line: int, time: str) -> float:
    """Frames a second from the seconds a frame."""
    words = time.split()
    if len(words) != 1:
        raise file.error(line, f"Frame Time: {shortened(time)}, expected one number of seconds")
    (seconds,) = file.numbers(line, words)
    if seconds < 1e-9:
        raise file.error(line, f"Frame Time: {time}, expected seconds above 0")
    rate = 1 / seconds
    if rate < 0.99 * SLOWEST:
        raise file.error(line, f"Frame Time: {time}, expected at most {1 / SLOWEST:g} second")
    # .0083333 is how files write 1/120; 0.033367 (29.97 Hz) is its own.
    whole = max(1, round(rate))
    return float(whole) if abs(rate / whole - 1) < 1e-4 else rate
