"""Read a BVH file: a hierarchy of joints, then one line of channel values for every frame.

The format is described by Meredith and Maddock, Motion Capture File Formats Explained (2001).
Where it is ambiguous, the common interpretation is used: rotations are about the joint's own axes
in the order of its channels, and a position channel of any joint replaces the joint's offset.
"""

import re
from pathlib import Path

import numpy as np

from numpy_cae.mocap.formats.bvh_hierarchy import BvhJoint, read_hierarchy
from numpy_cae.mocap.formats.channels import Channels, read_pose
from numpy_cae.mocap.formats.text_file import HEADER_SIZE, TextFile, quoted, whole_number
from numpy_cae.mocap.units import guess_unit, require_unit, stated_unit, stature
from numpy_cae.motion.motion import MAX_RATE, MIN_RATE, Motion, Note, Skeleton, whole_step

SLOWEST, FASTEST = 8.0, 2000.0
"""SLOWEST, FASTEST: no recorder of motion has a rate below or above these (frames a second)."""


def read_bvh(path: str | Path, unit: float | None = None, max_rate: float | None = None) -> Motion:
    """Read a BVH file.

    Parameters
    ----------
    path : path of the file
    unit : float, optional
        Metres in one unit of length of the file: 0.01 for centimetres. By default guessed from
        the size of the skeleton; the first of `Motion.notes` states the guess.
    max_rate : float, optional
        A rate (frames a second) that is high enough. If every n-th frame of the file gives this
        rate, the motion has this rate, and the frames between are only counted.

    Returns
    -------
    Motion
        In metres, in the axes and the order of joints of the file; `load_motion` turns it Y up.
        `notes` also say what is odd in the file: lines of the hierarchy that were skipped, a
        number of frames that is not that of the lines, or frames that are all equal.

    Raises
    ------
    MotionFileError
        If the file is damaged elsewhere; no frame is left out or added.
    ValueError
        If `unit` is not above 0.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import write_bvh
    >>> walk = make_take("walk", 1, seconds=2.0, rate=120.0).motion
    >>> write_bvh(walk, "walk.bvh", unit=0.01)
    >>> motion = read_bvh("walk.bvh", unit=0.01)
    >>> len(motion), motion.skeleton.names[:2]
    (240, ('root', 'lhipjoint'))
    """
    if unit is not None:
        unit = require_unit(unit)
    file = TextFile.read(path)
    joints, motion_line, skipped = read_hierarchy(file)
    rate, values, miscounted = _read_motion(file, motion_line, joints, max_rate)
    del file  # the text of an hour at 120 Hz takes half a gigabyte
    skeleton = _skeleton(joints)
    rotations, translations = read_pose(_channels(joints, 1.0), skeleton.offsets, values)
    is_still = len(values) > 1 and (values[-1] == values[0]).all() and (values == values[0]).all()
    del values
    # Where a joint has position channels, its offset may be wrong: the median in the motion is not.
    lengths = np.nanmedian(np.linalg.norm(translations, axis=-1), axis=0)
    height = stature(skeleton, lengths)
    if unit is not None:
        note = stated_unit(unit, "as given", unit * height)
    else:
        unit, note = guess_unit(height)
    translations *= unit
    still = [Note("still", "nothing moves: all frames are equal")] if is_still else []
    notes = (note, *skipped, *miscounted, *still)
    return Motion(skeleton.scaled(unit), rate, rotations, translations, unit, notes)


def bvh_channels(path: str | Path, unit: float) -> list[Channels]:
    """The channels of each joint of a BVH file; `unit` is metres in its unit of length."""
    joints, *_ = read_hierarchy(TextFile.read(path, size=HEADER_SIZE))
    return _channels(joints, unit)


def _channels(joints: list[BvhJoint], unit: float) -> list[Channels]:
    channels, first = [], 0
    for joint in joints:
        channels.append(Channels(tuple(joint.channels or ()), first, unit))
        first += len(joint.channels or ())
    return channels


def _skeleton(joints: list[BvhJoint]) -> Skeleton:
    """In the unit of the file."""
    return Skeleton(
        tuple(joint.name for joint in joints),
        tuple(joint.parent for joint in joints),
        np.array([joint.offset for joint in joints], dtype=np.float64),
        {index: np.array(joint.tip) for index, joint in enumerate(joints) if joint.tip is not None},
    )


def _read_motion(
    file: TextFile, motion_line: int, joints: list[BvhJoint], max_rate: float | None
) -> tuple[float, np.ndarray, list[Note]]:
    """The frames a second and the table (frames, channels) in the text below MOTION, and a note if
    the number of frames that the file states is not that of the lines."""
    channels = sum(len(joint.channels or []) for joint in joints)
    count_line, count = _header(file, motion_line, r"frames\s*:?\s*(.*)", "Frames: and a number")
    pattern = r"frame\s*time\s*:?\s*(.*)"
    time_line, time = _header(file, count_line, pattern, "Frame Time: and seconds")
    stated = whole_number(count)
    if stated is None:
        raise file.error(count_line, f"Frames: {quoted(count)}, expected a whole number")
    rate = _rate(file, time_line, time)
    if channels == 0:
        raise file.error(motion_line, "no joint has CHANNELS, so there is no motion to read")

    step = 1 if max_rate is None else max(1, whole_step(rate, max_rate))
    expected = "a line for each frame, with one value for each channel of the hierarchy"
    rate = rate if step == 1 or max_rate is None else max_rate

    def read(frames: int) -> tuple[np.ndarray, int]:
        file.require_frames(min(frames, file.count) // step, len(joints), rate)
        return file.table(time_line, channels, frames, expected, step)

    values, lines = read(max(stated, 1))
    notes = []
    if lines == 0:
        joined = "but" if stated else "and"
        raise file.error(count_line, f"Frames: says {count}, {joined} no line of values follows")
    if lines != stated:
        text = f"Frames: says {count}, but {lines} lines of values follow and were read"
        notes.append(Note("frames", text))
        values, _ = read(lines)
    if not SLOWEST <= rate <= FASTEST:
        text = f"Frame Time: {time} is {rate:.3g} frames a second; is that right?"
        notes.append(Note("rate", text, in_doubt=True))
    return rate, values, notes + file.lost_values(values)


def _header(file: TextFile, after: int, pattern: str, expected: str) -> tuple[int, str]:
    """The number of the next line that is not blank, and the first group of the pattern in it."""
    for line, text in file.numbered(after):
        match = re.fullmatch(pattern, text.strip(), re.IGNORECASE)
        if match is not None:
            return line, match[1]
        if text.strip():
            raise file.error(line, f"expected {expected}, found {quoted(text.strip())}")
    raise file.error(file.count, f"the file ends below MOTION, expected {expected}")


def _rate(file: TextFile, line: int, time: str) -> float:
    """Frames a second, from the text `time`, the seconds that a frame lasts."""
    (seconds,) = file.numbers(line, time.split(), 1, "Frame Time:")
    if not 0.99 / MAX_RATE <= seconds <= 1.01 / MIN_RATE:
        expected = f"expected seconds, {1 / MAX_RATE:g} to {1 / MIN_RATE:g}"
        raise file.error(line, f"Frame Time: {time}, {expected}")
    rate = 1 / seconds
    # Files write 1/120 as .0083333, which is rounded to 120 Hz. 0.033367 stays 29.97 Hz here: only
    # `whole_step`, which omits frames, takes it for 30 Hz.
    rounded = max(1, round(rate))
    return float(rounded) if abs(rate / rounded - 1) < 1e-4 else rate
