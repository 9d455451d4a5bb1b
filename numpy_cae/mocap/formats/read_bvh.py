"""Read a BVH file: a hierarchy of joints, then one line of channel values for every frame.

The format is described by Meredith and Maddock, Motion Capture File Formats Explained (2001).
Where it is ambiguous, the common interpretation is used: rotations are about the joint's own axes
in the order of its channels, and a position channel of any joint replaces the joint's offset.

The first half is the HIERARCHY: joints in a tree, each with its own channels. In it, lines that
begin with none of the format's words, such as comments, are skipped and counted.

HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  { ...
    End Site
    {
      OFFSET 0 10 0
    }
  }
}
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.mocap.formats.channels import Channels, JointChannels, read_pose
from numpy_cae.mocap.formats.text_file import MAX_JOINTS, TextFile, quote, whole_number
from numpy_cae.mocap.units import describe_unit, guess_unit, require_unit, stature
from numpy_cae.motion.motion import MAX_RATE, MIN_RATE, Motion, Note, Skeleton, whole_step

SLOWEST_RATE = 8.0
FASTEST_RATE = 2000.0
"""No recorder of motion has a rate (frames a second) below or above these."""
CHANNELS = {f"{axis}position": f"t{axis}" for axis in "XYZ"}
CHANNELS |= {f"{axis}rotation": f"r{axis}" for axis in "XYZ"}
"""For the usual spelling of each channel its name in `Channels`. Files differ in case."""
_LOWER_CASE = {name.lower(): short for name, short in CHANNELS.items()}
_KEYWORDS = {"HIERARCHY", "ROOT", "JOINT", "OFFSET", "CHANNELS", "End Site", "MOTION", "{", "}"}
_BRACES = re.compile(r"([{}])")
_BRACKETS = str.maketrans("[]()", "    ")
_COMMA = str.maketrans(",", " ")
"""Scripts write these characters around and between the numbers of a vector."""
NumberedLines = Iterator[tuple[int, str]]
_SKIPPABLE = re.compile(r"[^-+.\d{}][^{}]*")
"""A line that may be skipped has no brace and is no row of numbers."""


@dataclass
class BvhJoint:
    """A ROOT or JOINT block that begins on `line`, or an End Site; vectors are in the file's unit.

    `may_follow` are the statements that may follow: "{" alone where it is the first, "}" only
    after OFFSET. `channels` are names such as "tX" or "rZ", in the order of the file. `end` is the
    joint's End Site, the first if a hand has one for each finger.
    """

    name: str
    index: int
    parent: int
    line: int
    may_follow: list[str]
    offset: list[float] | None = None
    channels: tuple[str, ...] = ()
    end: "BvhJoint | None" = None


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
    file = TextFile.read(path)
    lines = file.numbered_lines()
    joints, skipped = _Hierarchy(file).read(lines)
    rate, values, miscounted = _read_motion(file, lines, joints, max_rate)
    del file, lines  # the text of an hour at 120 Hz takes half a gigabyte
    skeleton = Skeleton(
        tuple(joint.name for joint in joints),
        tuple(joint.parent for joint in joints),
        np.array([joint.offset for joint in joints], dtype=np.float64),
        {index: np.array(joint.end.offset) for index, joint in enumerate(joints) if joint.end},
    )
    rotations, translations = read_pose(_channels(joints, 1.0), skeleton.offsets, values)
    still = _note_if_still(values)
    del values
    height = stature(skeleton, _bone_lengths(joints, translations))
    if unit is None:
        unit, note = guess_unit(height)
    else:
        note = describe_unit(require_unit(unit), "as given", unit * height)
    translations *= unit
    notes = (note, *skipped, *miscounted, *still)
    return Motion(skeleton.scaled(unit), rate, rotations, translations, unit, notes)


def _note_if_still(values: np.ndarray) -> list[Note]:
    """A note if all frames of a table (frames, channels) are equal, and there are several."""
    if len(values) > 1 and (values[-1] == values[0]).all() and (values == values[0]).all():
        return [Note("still", "nothing moves: all frames are equal")]
    return []


def _bone_lengths(joints: list[BvhJoint], translations: np.ndarray) -> np.ndarray:
    """The length of the bone that ends at each joint, (J,), from translations (F, J, 3).

    Where a joint has position channels, its offset may be wrong: the median in the motion is not.
    """
    lengths = np.linalg.norm(translations[0], axis=1)
    for joint in joints:
        if any(channel.startswith("t") for channel in joint.channels):
            steps = np.linalg.norm(translations[:, joint.index], axis=1)
            lengths[joint.index] = np.nanmedian(steps)
    return lengths


def bvh_channels(path: str | Path, unit: float) -> JointChannels:
    """The channels of each joint of a BVH file; `unit` is metres in its unit of length."""
    file = TextFile.read(path, header=True)
    joints, _ = _Hierarchy(file).read(file.numbered_lines())
    return _channels(joints, unit)


def _channels(joints: list[BvhJoint], unit: float) -> JointChannels:
    return {joint.name: Channels(joint.channels, unit) for joint in joints}


def _read_motion(
    file: TextFile, lines: NumberedLines, joints: list[BvhJoint], max_rate: float | None
) -> tuple[float, np.ndarray, list[Note]]:
    """The frames a second and the table (frames, channels) in the `lines` below MOTION, and a note
    if the number of frames that the file states is not that of the lines."""
    channels = sum(len(joint.channels) for joint in joints)
    count_line, count = _header(file, lines, "frames", "Frames: and a number")
    time_line, time = _header(file, lines, r"frame\s*time", "Frame Time: and seconds")
    stated = whole_number(count)
    if stated is None:
        raise file.error(count_line, f"Frames: {quote(count)}, expected a whole number")
    rate = _rate(file, time_line, time)
    if channels == 0:
        raise file.error(count_line, "no joint has CHANNELS, so there is no motion to read")

    step = 1 if max_rate is None else max(1, whole_step(rate, max_rate))
    expected = "a line for each frame, with one value for each channel of the hierarchy"
    rate = rate if step == 1 or max_rate is None else max_rate
    file.require_frames((file.count - time_line) // step, len(joints), rate)
    values, count_of_lines = file.table(time_line, channels, expected, step)
    notes = []
    if count_of_lines == 0:
        joined = "but" if stated else "and"
        raise file.error(count_line, f"Frames: says {count}, {joined} no line of values follows")
    if count_of_lines != stated:
        text = f"Frames: says {count}, but {count_of_lines} lines of values follow and were read"
        notes.append(Note("frames", text))
    if not SLOWEST_RATE <= rate <= FASTEST_RATE:
        text = f"Frame Time: {time} is {rate:.3g} frames a second; is that right?"
        notes.append(Note("rate", text, in_doubt=True))
    return rate, values, notes + file.lost_values(values)


def _header(file: TextFile, lines: NumberedLines, keyword: str, expected: str) -> tuple[int, str]:
    """The number of the next line that is not blank, and the text after the keyword in it."""
    for line, text in lines:
        match = re.fullmatch(rf"{keyword}\s*:?\s*(.*)", text.strip(), re.IGNORECASE)
        if match is not None:
            return line, match[1]
        if text.strip():
            raise file.error(line, f"expected {expected}, found {quote(text.strip())}")
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


class _Hierarchy:
    """Reads the HIERARCHY of a file.

    Attributes
    ----------
    joints : dict of str to BvhJoint
        Parents before children, by their names without prefix.
    blocks : list of BvhJoint
        The file, in which ROOT may follow, then the blocks that have not ended, the root's first.
    skipped : list of int
        The numbers of the lines that hold no statement.
    """

    def __init__(self, file: TextFile):
        self.file = file
        self.joints: dict[str, BvhJoint] = {}
        self.blocks = [BvhJoint("", -1, -1, 0, ["ROOT"])]
        self.skipped: list[int] = []

    def read(self, lines: NumberedLines) -> tuple[list[BvhJoint], list[Note]]:
        """The joints, and a note if lines were skipped; of `lines` those below MOTION are left.

        Raises MotionFileError if the block is not valid BVH.
        """
        for line, keyword, value in self._statements(lines):
            self._require_expected(line, f"{keyword} {value}".strip())
            if keyword == "MOTION":
                return [*self.joints.values()], self._notes()
            if keyword in ("ROOT", "JOINT", "End Site"):
                self.blocks.append(self._new_block(line, keyword, value))
                continue
            block = self.blocks[-1]
            if keyword == "{":
                block.may_follow.pop(0)
            elif keyword == "OFFSET":
                words = [word.strip(",") for word in value.translate(_BRACKETS).split()]
                words = words if len(words) == 3 else value.translate(_BRACKETS | _COMMA).split()
                block.offset = self.file.numbers(line, words, 3, "OFFSET")
                block.may_follow[0] = "}"
            elif keyword == "CHANNELS":
                block.channels = _channel_names(self.file, line, value)
                block.may_follow.remove("CHANNELS")
            else:
                self.blocks.pop()
        problem = f"the file ends{self._place()} without MOTION: is it cut off?"
        raise self.file.error(self.file.count, problem)

    def _notes(self) -> list[Note]:
        """A note if lines were skipped."""
        if not self.skipped:
            return []
        lines = "line" if len(self.skipped) == 1 else "lines"
        text = f"skipped {len(self.skipped)} unknown {lines} of the hierarchy"
        return [Note("skipped lines", f"{text}, first line {self.skipped[0]}")]

    def _statements(self, lines: NumberedLines) -> Iterator[tuple[int, str, str]]:
        """(line number, keyword, value) of each statement; a brace is one anywhere in a line."""
        started = False
        for line, text in lines:
            for statement in filter(None, map(str.strip, _BRACES.split(text))):
                keyword, value = [*statement.split(maxsplit=1), ""][:2]
                if not started and statement.upper() != "HIERARCHY":
                    problem = "expected HIERARCHY, as every BVH file begins, found"
                    raise self.file.error(line, f"{problem} {quote(statement)}")
                if keyword.upper() in ("END", "ENDSITE"):  # some programs name it: End left_hand
                    yield line, "End Site", ""
                elif keyword.upper() not in _KEYWORDS and _SKIPPABLE.fullmatch(text.strip()):
                    self.skipped.append(line)
                elif started:
                    yield line, keyword.upper(), value
                started = True

    def _require_expected(self, line: int, statement: str) -> None:
        """Raise MotionFileError unless this statement may follow here."""
        keyword, _, name = statement.partition(" ")
        expected = self.blocks[-1].may_follow
        expected = expected[:1] if expected[0] == "{" else expected
        if keyword == "ROOT" and expected == ["MOTION"]:
            problem = f"a second ROOT, {quote(name)}: a file may hold one skeleton; delete this"
            raise self.file.error(line, f"{problem} one and its columns of values")
        if keyword not in expected and statement not in expected:
            problem = f"expected {' or '.join(expected)}{self._place()}, found {quote(statement)}"
            raise self.file.error(line, problem)

    def _place(self) -> str:
        """The block that has not ended, for an error."""
        block = self.blocks[-1]
        return f" in {block.name!r} (line {block.line})" if block.line else ""

    def _new_block(self, line: int, keyword: str, name: str) -> BvhJoint:
        """The joint or End Site that begins on a line; a joint is added to the joints."""
        parent = self.blocks[-1].index
        if keyword == "End Site":
            joint = self.blocks[-1]
            end = BvhJoint(f"End Site of {joint.name}", -1, parent, line, ["{", "OFFSET"])
            joint.end = joint.end or end
            return end
        plain = name.rsplit(":", 1)[-1]
        if not name or plain in self.joints:
            problem = "expected a name that is unique without its prefix up to a colon"
            raise self.file.error(line, f"{keyword} {name!r}: {problem}")
        if len(self.joints) == MAX_JOINTS:
            raise self.file.error(line, f"the skeleton has more than {MAX_JOINTS} joints")
        self.blocks[0].may_follow = ["MOTION"]
        may_follow = ["{", "OFFSET", "CHANNELS", "JOINT", "End Site"]
        self.joints[plain] = BvhJoint(name, len(self.joints), parent, line, may_follow)
        return self.joints[plain]


def _channel_names(file: TextFile, line: int, value: str) -> tuple[str, ...]:
    count, *names = value.split() or [""]
    channels = tuple(_LOWER_CASE.get(name.lower(), "") for name in names)
    if "" in channels or len(set(channels)) < len(names) or whole_number(count) != len(names):
        expected = f"the number of channels and different names of {', '.join(CHANNELS)}"
        raise file.error(line, f"CHANNELS {quote(value)}: expected {expected}")
    return channels
