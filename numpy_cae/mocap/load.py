"""Load any supported motion file, chosen by its suffix."""

import logging
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fnmatch import fnmatch
from functools import partial
from pathlib import Path
from typing import TypedDict, Unpack

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.mocap.coordinates import require_coordinates, turn_y_up
from numpy_cae.mocap.file_motion import FileMotion
from numpy_cae.mocap.formats.amc import read_amc
from numpy_cae.mocap.formats.expmap import is_expmap_text, read_expmap
from numpy_cae.mocap.formats.read_bvh import read_bvh
from numpy_cae.mocap.formats.text_file import MotionFileError
from numpy_cae.mocap.retargeting.body import body_of
from numpy_cae.mocap.retargeting.to_angles import angles_of
from numpy_cae.mocap.rigs.recognise import recognise_rig
from numpy_cae.mocap.rigs.rigs import Mappings, UnknownRigError
from numpy_cae.mocap.units import guess_unit_from_limbs
from numpy_cae.motion import AngleSequence, Motion

log = logging.getLogger(__name__)

SUPPORTED = (
    "supported are .bvh (BVH), .amc (Acclaim, its skeleton in an .asf file beside it) and .txt "
    "(exponential maps of CMU or Human3.6M)"
)
SUFFIXES = (".amc", ".bvh", ".txt")


def load_motion(
    path: str | Path,
    unit: float | None = None,
    max_rate: float | None = None,
    up: str | None = None,
    floor: float | None = None,
    mapping: Mappings = None,
) -> FileMotion:
    """Read a motion from any supported file; the skeleton of an .amc file is looked for beside it.

    The motion is turned to Y up and its floor moved to 0; `Motion.up` and `Motion.floor` say how
    the file has them, and the writers restore that. Joints that the rig lacks and whose place is
    known are added (`add_missing_joints`).

    Parameters
    ----------
    path : path of a .bvh, .amc or .txt file
    unit : float, optional
        Metres in one unit of length of the file, such as 0.01 for centimetres. By default guessed
        for BVH, else as the file or its layout says; see `Motion.notes`.
    max_rate : float, optional
        Frames a second that suffice: if omitting frames gives this rate, they are not parsed.
    up, floor : str, float, optional
        The axis that is up in the file (x, y, z, -x, -y or -z), and the height of the floor along
        it in metres. By default detected.
    mapping : dict of joint name to the rig's joint name, or several, optional
        Names of the twenty joints in an unknown rig. If there are several mappings, the first whose
        names are all in the file is used, or none.

    Returns
    -------
    FileMotion
        A `Motion` that knows its file and its rig (`rig_of`) and has a method `save`.

    Raises
    ------
    MotionFileError
        If the file is missing, damaged or of a kind that is not supported.
    ValueError
        If `unit`, `up` or `floor` is not valid.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import write_bvh
    >>> walk = make_take("walk", 1, seconds=2.0, rate=120.0).motion
    >>> write_bvh(walk, "walk.bvh", unit=0.01)
    >>> motion = load_motion("walk.bvh")
    >>> len(motion), motion.rate, motion.note
    (240, 120.0, 'centimetres (guessed: the skeleton is about 1.8 m tall)')
    """
    path = Path(path)
    _require_supported(path)
    require_coordinates(unit, up, floor)
    with _naming_file(path):
        motion = recognise_rig(_read(path, unit, max_rate), mapping)
        if path.suffix.lower() == ".bvh" and unit is None:
            motion = guess_unit_from_limbs(motion)
        is_odd = any(note.kind != "unit" or note.in_doubt for note in motion.notes)
        motion = turn_y_up(motion, up, floor)
    log.log(logging.WARNING if is_odd else logging.INFO, "%s: %s", path, motion.note)
    reload = partial(load_motion, path, unit, None, up, floor, mapping)
    return FileMotion(**vars(motion), source=path, reload=reload)


def _require_supported(path: Path) -> None:
    """Raise MotionFileError unless the path is that of a motion file, by its suffix."""
    suffix = path.suffix.lower()
    if os.path.isdir(path):
        problem = f"is a folder, expected one motion file; {SUPPORTED}"
    elif not os.path.exists(path):
        problem = f"there is no such file; {SUPPORTED}"
    elif suffix == ".asf":
        problem = "is a skeleton without motion, expected the .amc file that moves it"
    elif suffix not in SUFFIXES:
        problem = f"{suffix or 'a file without suffix'} is not supported; {SUPPORTED}"
    else:
        return
    raise MotionFileError(path, None, problem)


def _read(path: Path, unit: float | None, max_rate: float | None) -> Motion:
    """The motion in a file, in the axes of the file."""
    suffix = path.suffix.lower()
    if suffix == ".amc":
        return read_amc(path, unit, max_rate)
    if suffix == ".bvh":
        return read_bvh(path, unit, max_rate)
    return read_expmap(path, unit)


@contextmanager
def _naming_file(path: str | Path) -> Iterator[None]:
    """Name the file in an `UnknownRigError` of the block, and turn any unexpected exception into a
    `MotionFileError` that names it, so that one strange file does not end the reading of thousands.
    """
    try:
        yield
    except UnknownRigError as error:
        raise UnknownRigError(f"{path}: {error}") from None
    except (NumpyCaeError, MemoryError):
        raise
    except Exception as error:
        problem = f"cannot be read: {type(error).__name__}: {error}"
        raise MotionFileError(path, None, " ".join(problem.split())) from error


class LoadOptions(TypedDict, total=False):
    """The parameters of `load_motion`, all of them optional."""

    unit: float | None
    max_rate: float | None
    up: str | None
    floor: float | None
    mapping: Mappings


def load_body(path: str | Path, **options: Unpack[LoadOptions]) -> tuple[np.ndarray, Motion]:
    """The twenty joints of a file at thirty frames a second, and the motion at the file's rate.

    Parameters
    ----------
    path : path of the file
    **options
        `unit`, `max_rate`, `up`, `floor` and `mapping`, as in `load_motion`.

    Returns
    -------
    positions : (F, 20, 3) array of float64
        World positions in metres at `RATE`.
    motion : Motion

    Raises
    ------
    MotionFileError
        If the file cannot be read.
    UnknownRigError
        If joints are missing; the message names the file.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import write_bvh
    >>> walk = make_take("walk", 1, seconds=2.0, rate=120.0).motion
    >>> write_bvh(walk, "walk.bvh", unit=0.01)
    >>> positions, motion = load_body("walk.bvh")
    >>> positions.shape, len(motion)
    ((60, 20, 3), 240)
    """
    motion = load_motion(path, **options)
    with _naming_file(path):
        return body_of(motion), motion


def load_angles(path: str | Path, **options: Unpack[LoadOptions]) -> AngleSequence:
    """`angles_of` any motion file. No floor is looked for: clips are relative to their start.

    Parameters
    ----------
    path : path of the file
    **options
        `unit`, `max_rate`, `up` and `mapping`, as in `load_motion`.

    Returns
    -------
    AngleSequence

    Raises
    ------
    MotionFileError
        If the file cannot be read.
    UnknownRigError
        If joints are missing; the message names the file.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import write_bvh
    >>> walk = make_take("walk", 1, seconds=2.0, rate=120.0).motion
    >>> write_bvh(walk, "walk.bvh", unit=0.01)
    >>> load_angles("walk.bvh").numbers.shape
    (50, 54)
    """
    options["floor"] = 0.0
    motion = load_motion(path, **options)
    with _naming_file(path):
        return angles_of(motion)


def find_motion_files(folder: str | Path) -> list[Path]:
    """The motion files in a folder and its subfolders; a .txt counts if it holds exponential maps.

    Parameters
    ----------
    folder : path

    Returns
    -------
    list of Path
        Sorted.

    Raises
    ------
    MotionFileError
        If there is no such folder or it holds no such file.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import write_bvh
    >>> walk = make_take("walk", 1, seconds=2.0, rate=120.0).motion
    >>> write_bvh(walk, "walk.bvh", unit=0.01)
    >>> [path.name for path in find_motion_files(".")]
    ['walk.bvh']
    """
    folder = Path(folder)
    if not folder.is_dir():
        problem = "is a file, expected a folder" if folder.exists() else "there is no such folder"
        raise MotionFileError(folder, None, problem)
    paths = sorted(path for path in folder.rglob("*") if _is_motion_file(path))
    if not paths:
        raise MotionFileError(folder, None, f"holds no motion file; {SUPPORTED}")
    return paths


def _is_motion_file(path: Path) -> bool:
    suffix = path.suffix.lower()
    # A name that begins with a dot is a system's note about a file, not the file.
    if suffix not in SUFFIXES or not path.is_file() or path.name.startswith("."):
        return False
    return suffix != ".txt" or is_expmap_text(path)


def matches_any(path: Path, patterns: Sequence[str]) -> bool:
    """Whether a file's name matches one of the patterns, such as "*_005.bvh"."""
    return any(fnmatch(path.name, pattern) for pattern in patterns)
