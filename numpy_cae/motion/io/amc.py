"""Read an Acclaim motion (.amc) with its skeleton (.asf): per frame, a line for every bone.

Angles are about fixed axes in the order of the skeleton's `dof` (for the root: of its `order`),
so that `rx ry rz` is R = R_z · R_y · R_x; how that turns the bone stands in `read_asf`.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from numpy_cae.motion.io.asf import AcclaimSkeleton, read_asf
from numpy_cae.motion.io.error import MotionFileError
from numpy_cae.motion.io.text_file import SLOWEST, TextFile, parsed, shortened, whole_number
from numpy_cae.motion.io.units import stature, unit_name
from numpy_cae.motion.motion import Motion, whole_step
from numpy_cae.motion.quaternions import IDENTITY, from_euler, product

log = logging.getLogger(__name__)

CMU_RATE = 120.0


def read_amc(
    path: str | Path,
    skeleton_path: str | Path | None = None,
    rate: float | None = None,
    unit: float | None = None,
    wanted: float | None = None,
) -> Motion:
    """Read an Acclaim motion.

    The format does not say how many frames there are, so that frames cut off at the end of the
    file are noticed only where the last one is not whole.

    Parameters
    ----------
    path : path of the .amc file
    skeleton_path : path of the .asf file, optional
        By default looked for beside the motion, as `find_skeleton` does.
    rate : float, optional
        Frames a second. By default what `:SAMPLES-PER-SECOND` says, which few files have; else
        120, the rate of the CMU database.
    unit : float, optional
        Metres in one unit of the files; by default as the skeleton says.
    wanted : float, optional
        Frames a second that are enough, as in `read_bvh`.

    Returns
    -------
    Motion
        In metres; a joint is named for its bone and sits at the bone's base.

    Raises
    ------
    MotionFileError
        If either file is damaged or the two do not fit: never is a motion shortened or filled.
    ValueError
        If `rate` or `unit` is not above 0.
    """
    acclaim, degrees, rate, values = read_amc_channels(path, skeleton_path, rate, unit, wanted)
    rotations, translations = _pose(acclaim, values, degrees)
    source = ":units of the skeleton" if unit is None else "as given"
    tall = stature(acclaim.skeleton)
    note = f"{unit_name(acclaim.unit)} ({source}; the skeleton stands about {tall:.1f} m tall)"
    return Motion(acclaim.skeleton, rate, rotations, translations, acclaim.unit, note)


def read_amc_channels(
    path: str | Path,
    skeleton_path: str | Path | None = None,
    rate: float | None = None,
    unit: float | None = None,
    wanted: float | None = None,
) -> tuple[AcclaimSkeleton, bool, float, np.ndarray]:
    """What an AMC file says, as it says it: the numbers that `read_amc` makes a motion of.

    Parameters and errors are those of `read_amc`.

    Returns
    -------
    acclaim : AcclaimSkeleton
    degrees : bool
        Whether angles are degrees, not radians.
    rate : float
        Frames a second.
    values : (frames, channels) array of float64
        In the order of the skeleton's joints and their channels.
    """
    if rate is not None and not (np.isfinite(rate) and rate > 0):
        raise ValueError(f"rate is {rate}, expected frames a second above 0")
    motion_file = TextFile.read(path)
    if skeleton_path is None:
        skeleton_path = find_skeleton(path)
        log.info("%s: skeleton from %s", path, skeleton_path)
    acclaim = read_asf(skeleton_path, unit)
    degrees, said_rate, start = _read_header(motion_file, acclaim.degrees)
    if rate is None:
        rate = said_rate or CMU_RATE
    step = 1 if wanted is None else max(1, whole_step(rate, wanted))
    values = _read_frames(motion_file, acclaim, start, step)
    return acclaim, degrees, float(wanted if step > 1 else rate), values


def find_skeleton(path: str | Path) -> Path:
    """The .asf file in the folder of an .amc file: of the same name, else of the longest name
    that the motion's begins with before a _ (`02.asf` for `02_01.amc`), else the only one.

    Raises
    ------
    MotionFileError
        If there is none, or several and none of them fits.
    """
    path = Path(path)
    skeletons = sorted(file for file in path.parent.iterdir() if file.suffix.lower() == ".asf")
    fitting = [asf for asf in skeletons if f"{path.stem}_".startswith(f"{asf.stem}_")]
    if fitting:
        return max(fitting, key=lambda asf: len(asf.stem))
    if len(skeletons) == 1:
        return skeletons[0]
    there = ", ".join(asf.name for asf in skeletons) or "no .asf file"
    raise MotionFileError(
        path,
        None,
        f"its skeleton is not clear: the folder holds {there}, expected "
        f"{path.stem.split('_')[0]}.asf; name the .asf file that belongs to it",
    )


def _statements(file: TextFile, after: int = 0) -> Iterator[tuple[int, list[str]]]:
    for line, text in file.numbered(after):
        words = (text.partition("#")[0] if "#" in text else text).split()
        if words:
            yield line, words


def _read_header(file: TextFile, degrees: bool) -> tuple[bool, float | None, int]:
    """Whether angles are degrees, the rate if it is said, and the last line before the frames."""
    rate = None
    for line, words in _statements(file):
        keyword = words[0].lower()
        if not keyword.startswith(":"):
            return degrees, rate, line - 1
        if keyword in (":degrees", ":radians"):
            degrees = keyword == ":degrees"
        elif keyword == ":samples-per-second":
            numbers = file.numbers(line, words[1:])
            if len(numbers) != 1 or numbers[0] < SLOWEST:
                raise file.error(
                    line, f":SAMPLES-PER-SECOND, expected one number above 0, {SLOWEST:g} or more"
                )
            rate = numbers[0]
    raise file.error(file.count, "the file ends before the first frame")


def _read_frames(file: TextFile, acclaim: AcclaimSkeleton, start: int, step: int) -> np.ndarray:
    """The table (every `step`-th frame, channels), columns in the order of the skeleton's joints.

    A file as programs write it says the same bones in the same order in every frame, and is parsed
    a bone at a time; any other is read line by line, which finds what is wrong.
    """
    values = _regular_frames(file, acclaim, start, step)
    if values is None:
        values = _any_frames(file, acclaim, start)[::step]
    file.require_meaning(len(values), len(acclaim.skeleton.names))
    return values


def _regular_frames(
    file: TextFile, acclaim: AcclaimSkeleton, start: int, step: int
) -> np.ndarray | None:
    """The table where every frame is laid out as the first one, None where one is not."""
    lines = file.lines[start:]
    while lines and not lines[-1]:
        lines.pop()
    counts = {
        name: len(channels)
        for name, channels in zip(acclaim.skeleton.names, acclaim.channels, strict=True)
        if channels
    }
    bones = [text.partition(" ")[0] for text in lines[1 : len(counts) + 1]]
    height = len(bones) + 1
    frames, rest = divmod(len(lines), height)
    first = whole_number(lines[0])
    if rest or first is None or sorted(bones) != sorted(counts):
        return None
    if lines[::height] != [str(number) for number in range(first, first + frames)]:
        return None
    columns = {}
    for place, bone in enumerate(bones, start=1):
        rows, begin = lines[place :: height * step], f"\n{bone} "
        text = "\n".join(["", *rows])
        if text.count(begin) != len(rows):
            return None
        columns[bone] = parsed(text.replace(begin, "\n").encode(), counts[bone], start=1)
        if columns[bone] is None:
            return None
    return np.concatenate([columns[name] for name in counts], axis=1)


def _any_frames(file: TextFile, acclaim: AcclaimSkeleton, start: int) -> np.ndarray:
    """The same, read line by line: a comment, a blank or another order of bones does no harm."""
    names = acclaim.skeleton.names
    counts = {name: len(channels) for name, channels in zip(names, acclaim.channels, strict=True)}
    moving = [name for name, count in counts.items() if count]
    rows: list[np.ndarray] = []
    frame: dict[str, list[float]] = {}
    number = frame_line = None

    def finish() -> None:
        missing = [name for name in moving if name not in frame]
        if missing:
            raise file.error(frame_line, f"frame {number} has no values for {', '.join(missing)}")
        rows.append(np.array([value for name in moving for value in frame[name]]))

    for line, words in _statements(file, start):
        name = words[0]
        if len(words) == 1 and name not in counts:
            following = whole_number(name)
            if following is None:
                raise file.error(
                    line,
                    f"{shortened(name)}, expected the number of a frame or a bone of the "
                    "skeleton with its values",
                )
            if number is not None:
                finish()
                if following != number + 1:
                    raise file.error(
                        line, f"frame {following} follows frame {number}, expected {number + 1}"
                    )
            number, frame_line, frame = following, line, {}
            continue
        if name not in counts:
            raise file.error(
                line, f"the skeleton has no bone {shortened(name)}; it has {', '.join(names)}"
            )
        if number is None:
            raise file.error(line, f"bone {name!r} stands before the number of the first frame")
        if name in frame:
            raise file.error(line, f"bone {name!r} stands a second time in frame {number}")
        if len(words) - 1 != counts[name]:
            channels = " ".join(acclaim.channels[names.index(name)])
            raise file.error(
                line,
                f"bone {name!r} has {len(words) - 1} values, expected {counts[name]}"
                + (f" ({channels})" if channels else ": the skeleton gives it no dof"),
            )
        frame[name] = file.numbers(line, words[1:])
    finish()
    return np.array(rows)


def _pose(
    acclaim: AcclaimSkeleton, values: np.ndarray, degrees: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions (F, J, 4) and translations (F, J, 3) in metres."""
    frames, joints = len(values), len(acclaim.skeleton.names)
    rotations = np.empty((frames, joints, 4))
    translations = np.tile(acclaim.skeleton.offsets, (frames, 1, 1))
    values = np.ascontiguousarray(values.T)  # a channel's numbers side by side
    column = 0
    for joint, (channels, axes) in enumerate(zip(acclaim.channels, acclaim.axes, strict=True)):
        order, columns = "", []
        for channel in channels:
            if channel.startswith("t"):
                # The root's translation adds to its preset position, which is its offset.
                translations[:, joint, "xyz".index(channel[1])] += acclaim.unit * values[column]
            else:
                order += channel[1]
                columns.append(column)
            column += 1
        if order:
            # Small letters turn about fixed axes, the first of them first.
            turned = from_euler(order, values[columns].T, degrees)
            # C · R · C⁻¹ turns as far as R, about C's axis of it.
            turned[:, :3] = axes.apply(turned[:, :3])
        else:
            turned = IDENTITY
        rotations[:, joint] = (
            product(acclaim.orientation.as_quat(), turned) if joint == 0 else turned
        )
    return rotations, translations
