"""Read an Acclaim motion (.amc) with its skeleton (.asf): in each frame, one line for each bone.

Angles are about fixed axes in the order of the skeleton's `dof` (the root's: in that of `order`).
`rx ry rz` is therefore R = R_z · R_y · R_x; the module `asf` defines the axes.
"""

from array import array
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from numpy_cae.mocap.formats.asf import ANGLE_UNITS, read_asf, statements
from numpy_cae.mocap.formats.channels import JointChannels, read_pose
from numpy_cae.mocap.formats.text_file import MotionFileError, TextFile, quote, whole_number
from numpy_cae.mocap.units import describe_unit, stature
from numpy_cae.motion.motion import MAX_RATE, MIN_RATE, Motion, whole_step

CMU_RATE = 120.0


def read_amc(path: str | Path, unit: float | None = None, max_rate: float | None = None) -> Motion:
    r"""Read an Acclaim motion; a joint is named for its bone and is at the bone's base.

    The format does not state the number of frames. A file that has been cut off is therefore
    noticed only if its last frame is incomplete.

    Parameters
    ----------
    path : path of the .amc file, whose .asf file `find_skeleton` finds
    unit, max_rate : float, optional
        As in `read_bvh`; by default the unit is the skeleton's. The rate is stated by
        `:SAMPLES-PER-SECOND`; few files have this, and 120, CMU's rate, is assumed in the others.

    Returns
    -------
    Motion
        In metres and in the axes of the file.

    Raises
    ------
    MotionFileError
        If either file is damaged or the two do not fit; a motion is never truncated or padded.

    Examples
    --------
    >>> _ = Path("01.asf").write_text(
    ...     ":root\n position 0 0 0\n:bonedata\n"
    ...     "begin\n name arm\n direction 1 0 0\n length 5\n axis 0 0 0 XYZ\n dof rx\n end\n"
    ...     ":hierarchy\n root arm\n"
    ... )
    >>> _ = Path("01_01.amc").write_text("1\nroot 0 35 0 0 0 0\narm 90\n")
    >>> motion = read_amc("01_01.amc")
    >>> motion.rate, motion.positions()[0, 0].round(3)
    (120.0, array([0.   , 0.889, 0.   ]))
    """
    file = TextFile.read(path)
    skeleton, channels, metres = read_asf(find_skeleton(path), unit)
    channels, rate, header = _read_header(file, channels)
    step = 1 if max_rate is None else max(1, whole_step(rate, max_rate))
    rate = rate if step == 1 or max_rate is None else max_rate
    values = _frames(file, channels, header, step, rate)
    rotations, translations = read_pose(channels, skeleton.offsets, values)
    source = ":units of the skeleton" if unit is None else "as given"
    height = stature(skeleton, np.linalg.norm(skeleton.offsets, axis=-1))
    unit_note = describe_unit(metres, source, height)
    notes = (unit_note, *file.lost_values(values))
    return Motion(skeleton, float(rate), rotations, translations, metres, notes)


def amc_channels(path: str | Path, unit: float) -> JointChannels:
    """The channels of each joint of an Acclaim motion; `unit` is metres in its unit of length."""
    file = TextFile.read(path, header=True)
    return _read_header(file, read_asf(find_skeleton(path), unit)[1])[0]


def amc_values(path: str | Path) -> np.ndarray:
    """The values of an Acclaim motion, unchanged, as a table (frames, channels) with its columns in
    the order of the skeleton's joints."""
    file = TextFile.read(path)
    channels, rate, header = _read_header(file, read_asf(find_skeleton(path))[1])
    return _frames(file, channels, header, 1, rate)


def find_skeleton(path: str | Path) -> Path:
    """The skeleton of an .amc file: an .asf file in the same folder.

    It has the same name or, if there is no such file, the longest name that is a prefix of the
    motion's up to an underscore (`02.asf` for `02_01.amc`). If no name fits, it is the only .asf
    file. Raises MotionFileError if there is none, or if there are several and no name fits.
    """
    path = Path(path)
    skeletons = sorted(file for file in path.parent.iterdir() if file.suffix.lower() == ".asf")
    fitting = [asf for asf in skeletons if f"{path.stem}_".startswith(f"{asf.stem}_")]
    if fitting:
        return max(fitting, key=lambda asf: len(asf.stem))
    if len(skeletons) == 1:
        return skeletons[0]
    present = ", ".join(asf.name for asf in skeletons) or "no .asf file"
    expected = f"{path.stem.split('_')[0]}.asf; copy its skeleton there under this name"
    problem = f"it is not clear which skeleton it has: the folder contains {present}"
    raise MotionFileError(path, None, f"{problem}, expected {expected}")


def _read_header(file: TextFile, channels: JointChannels) -> tuple[JointChannels, float, int]:
    """The channels in the angles of this file, the rate, and the last line before the frames."""
    rate = CMU_RATE
    for line, words in statements(file):
        keyword = words[0].lower()
        if not keyword.startswith(":"):
            return channels, rate, line - 1
        if keyword[1:] in ANGLE_UNITS:
            unit = ANGLE_UNITS[keyword[1:]]
            channels = {
                name: replace(of_bone, angle_unit=unit) for name, of_bone in channels.items()
            }
        elif keyword == ":samples-per-second":
            (rate,) = file.numbers(line, words[1:], 1, keyword)
            if not MIN_RATE <= rate <= MAX_RATE:
                expected = f"expected {MIN_RATE:g} to {MAX_RATE:g}"
                raise file.error(line, f"{keyword} {rate:g}, {expected}")
    raise file.error(file.count, "the file ends before the first frame")


def _frames(
    file: TextFile, channels: JointChannels, header: int, step: int, rate: float
) -> np.ndarray:
    """A table of every `step`-th frame, with its columns in the order of the skeleton's joints.

    `rate` is the rate of these frames. Comments, blanks and the order of the bones do not matter.
    """
    moving = [name for name, of_bone in channels.items() if of_bone.names]
    rows = array("d")
    for count, frame in enumerate(_read_frames(file, channels, header)):
        missing = [name for name in moving if name not in frame.values]
        if missing:
            problem = f"frame {frame.number} has no values for {', '.join(missing)}"
            raise file.error(frame.line, problem)
        if count % step == 0:
            rows.extend(frame.row(file, moving))
            file.require_frames(count // step + 1, len(channels), rate)
    frame.row(file, moving)  # the last frame may be cut off
    return np.frombuffer(rows).reshape(count // step + 1, -1)


class _Frame(NamedTuple):
    """A frame that begins on `line`: its number, and for each bone the line and its words."""

    line: int
    number: int
    values: dict[str, tuple[int, list[str]]]

    def row(self, file: TextFile, bones: list[str]) -> list[float]:
        """The numbers of these bones."""
        numbers: list[float] = []
        for name in bones:
            line, words = self.values[name]
            numbers += file.numbers(line, words)
        return numbers


def _read_frames(file: TextFile, channels: JointChannels, header: int) -> Iterator[_Frame]:
    """The frames below line `header`, at least one."""
    frame: _Frame | None = None
    for line, (name, *values) in statements(file, header):
        if name in channels:
            expected = channels[name].names
            if frame is None or name in frame.values or len(values) != len(expected):
                problem = f"bone {name!r} with {len(values)} values, expected it once in each frame"
                raise file.error(line, f"{problem}, with {len(expected)} ({' '.join(expected)})")
            frame.values[name] = line, values
            continue
        number = whole_number(name)
        if number is None or values or (frame is not None and number != frame.number + 1):
            after = "the first frame" if frame is None else f"frame {frame.number + 1}"
            expects = f"expected the number of {after} or a bone of the skeleton and its values"
            raise file.error(line, f"{quote(' '.join([name, *values]))}, {expects}")
        if frame is not None:
            yield frame
        frame = _Frame(line, number, {})
    assert frame is not None  # the header ends before a statement
    yield frame
