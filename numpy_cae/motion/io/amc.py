"""Read an Acclaim motion (.amc) with its skeleton (.asf): in each frame, one line for each bone.

Angles are about fixed axes in the order of the skeleton's `dof` (for the root: of its `order`),
so that `rx ry rz` is R = R_z · R_y · R_x; `asf` defines the axes.
"""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.io.asf import AcclaimSkeleton, read_asf, statements
from numpy_cae.motion.io.error import MotionFileError
from numpy_cae.motion.io.text_file import MIN_RATE, TextFile, quoted, whole_number
from numpy_cae.motion.io.units import stature, unit_name
from numpy_cae.motion.motion import Motion, whole_step

log = logging.getLogger(__name__)

CMU_RATE = 120.0


def read_amc(
    path: str | Path,
    skeleton_path: str | Path | None = None,
    rate: float | None = None,
    unit: float | None = None,
    max_rate: float | None = None,
) -> Motion:
    """Read an Acclaim motion.

    The format does not state the number of frames, so that frames missing at the end of the
    file are noticed only if the last one is incomplete.

    Parameters
    ----------
    path : path of the .amc file
    skeleton_path : path of the .asf file, optional
        By default the one that `find_skeleton` finds.
    rate : float, optional
        Frames a second. By default the file's `:SAMPLES-PER-SECOND`, which few files have; else
        120, the rate of the CMU database.
    unit : float, optional
        Metres in one unit of the files; by default as the skeleton says.
    max_rate : float, optional
        Frames a second that suffice, as in `read_bvh`.

    Returns
    -------
    Motion
        In metres; a joint is named for its bone and is at the bone's base.

    Raises
    ------
    MotionFileError
        If either file is damaged or the two do not fit; a motion is never truncated or padded.
    ValueError
        If `rate` or `unit` is not above 0.
    """
    if rate is not None and not (np.isfinite(rate) and rate > 0):
        raise ValueError(f"rate is {rate}, expected frames a second above 0")
    file = TextFile.read(path)
    if skeleton_path is None:
        skeleton_path = find_skeleton(path)
        log.info("%s: skeleton from %s", path, skeleton_path)
    acclaim = read_asf(skeleton_path, unit)
    degrees, file_rate, header = _read_header(file, acclaim.degrees)
    rate = rate or file_rate or CMU_RATE
    step = 1 if max_rate is None else max(1, whole_step(rate, max_rate))
    values = _regular_frames(file, acclaim, header, step)
    if values is None:
        values = _frames(file, acclaim, header)[::step]
    file.require_meaningful_size(len(values), len(acclaim.skeleton.names))
    rotations, translations = _pose(acclaim, values, degrees)
    source = ":units of the skeleton" if unit is None else "as given"
    height = stature(acclaim.skeleton)
    note = f"{unit_name(acclaim.unit)} ({source}; the skeleton stands about {height:.1f} m tall)"
    if step > 1 and max_rate is not None:
        rate = max_rate
    return Motion(acclaim.skeleton, float(rate), rotations, translations, acclaim.unit, note)


def find_skeleton(path: str | Path) -> Path:
    """The .asf file in the folder of an .amc file: the one of the same name, else the one with the
    longest name that begins the motion's before a _ (`02.asf` for `02_01.amc`), else the only one.

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
    found = ", ".join(asf.name for asf in skeletons) or "no .asf file"
    raise MotionFileError(
        path,
        None,
        f"its skeleton is not clear: the folder holds {found}, expected "
        f"{path.stem.split('_')[0]}.asf; name the .asf file that belongs to it",
    )


def _read_header(file: TextFile, degrees: bool) -> tuple[bool, float | None, int]:
    """Whether angles are degrees, the rate if stated, and the last line before the frames."""
    rate = None
    for line, words in statements(file):
        keyword = words[0].lower()
        if not keyword.startswith(":"):
            return degrees, rate, line - 1
        if keyword in (":degrees", ":radians"):
            degrees = keyword == ":degrees"
        elif keyword == ":samples-per-second":
            numbers = file.numbers(line, words[1:])
            if len(numbers) != 1 or numbers[0] < MIN_RATE:
                raise file.error(
                    line, f":SAMPLES-PER-SECOND, expected one number above 0, {MIN_RATE:g} or more"
                )
            rate = numbers[0]
    raise file.error(file.count, "the file ends before the first frame")


def _regular_frames(
    file: TextFile, acclaim: AcclaimSkeleton, header: int, step: int
) -> np.ndarray | None:
    """The table of every `step`-th frame if all frames have the layout of the first, else None.

    Files are written so; this reads them at three times the speed of `_frames`.
    """
    lines = file.data.decode().removesuffix("\n").split("\n")[header:]
    counts = acclaim.counts
    order = [line.partition(" ")[0] for line in lines[1 : len(counts) + 1]]
    height = len(order) + 1
    if sorted(order) != sorted(counts) or len(lines) % height:
        return None
    first, numbers = whole_number(lines[0]), lines[::height]
    if first is None or numbers != [str(first + i) for i in range(len(numbers))]:
        return None
    columns = {}
    for place, name in enumerate(order, start=1):
        rows = [line.split() for line in lines[place :: height * step]]
        if any(len(row) != counts[name] + 1 or row[0] != name for row in rows):
            return None
        try:
            columns[name] = file.numbers(0, [word for row in rows for word in row[1:]])
        except MotionFileError:
            return None
    return np.hstack([np.array(columns[name]).reshape(-1, counts[name]) for name in counts])


def _frames(file: TextFile, acclaim: AcclaimSkeleton, header: int) -> np.ndarray:
    """The table (frames, channels), columns in the order of the skeleton's joints, with an error
    for every line that does not fit; comments, blanks and the order of bones do not matter."""
    names, counts = acclaim.skeleton.names, acclaim.counts
    rows: list[list[float]] = []
    frame: dict[str, list[float]] = {}
    number = frame_line = None

    def finish() -> None:
        missing = [name for name in counts if name not in frame]
        if missing:
            raise file.error(frame_line, f"frame {number} has no values for {', '.join(missing)}")
        rows.append([value for name in counts for value in frame[name]])

    for line, (name, *values) in statements(file, header):
        if not values and name not in names:
            following = whole_number(name)
            if following is None:
                raise file.error(
                    line,
                    f"{quoted(name)}, expected the number of a frame or a bone of the "
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
        if name not in names:
            raise file.error(
                line, f"the skeleton has no bone {quoted(name)}; it has {', '.join(names)}"
            )
        if number is None:
            raise file.error(line, f"bone {name!r} stands before the number of the first frame")
        if name in frame:
            raise file.error(line, f"bone {name!r} stands a second time in frame {number}")
        channels = acclaim.channels[names.index(name)]
        if len(values) != len(channels):
            reason = f" ({' '.join(channels)})" if channels else ": the skeleton gives it no dof"
            raise file.error(
                line,
                f"bone {name!r} has {len(values)} values, expected {len(channels)}{reason}",
            )
        frame[name] = file.numbers(line, values)
    finish()
    return np.array(rows)


def _pose(
    acclaim: AcclaimSkeleton, values: np.ndarray, degrees: bool
) -> tuple[np.ndarray, np.ndarray]:
    """Quaternions (F, J, 4) and translations (F, J, 3) in metres."""
    frames, joints = len(values), len(acclaim.skeleton.names)
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (frames, joints, 1))
    translations = np.tile(acclaim.skeleton.offsets, (frames, 1, 1))
    column = 0
    for joint, (channels, axes) in enumerate(zip(acclaim.channels, acclaim.axes, strict=True)):
        order, columns = "", []
        for channel in channels:
            if channel.startswith("t"):
                # The root's translation is added to its preset position, which is its offset.
                translations[:, joint, "xyz".index(channel[1])] += acclaim.unit * values[:, column]
            else:
                order += channel[1]
                columns.append(column)
            column += 1
        if order:
            # Lower-case letters are fixed axes, applied from left to right.
            turn = Rotation.from_euler(order, values[:, columns], degrees=degrees)
            rotations[:, joint] = (axes * turn * axes.inv()).as_quat()
    root = acclaim.orientation * Rotation.from_quat(rotations[:, 0])
    rotations[:, 0] = root.as_quat()
    return rotations, translations
