"""Load any supported motion file, chosen by its suffix, and save a motion.

A motion is written as BVH, or with the text of the file that it came from.
"""

import filecmp
import logging
import os
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fnmatch import fnmatch
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.errors import FileError, NumpyCaeError
from numpy_cae.mocap.coordinates import in_y_up, require_coordinates, with_unit_of_limbs
from numpy_cae.mocap.formats.amc import find_skeleton, read_amc
from numpy_cae.mocap.formats.expmap import is_expmap_text, read_expmap
from numpy_cae.mocap.formats.read_bvh import read_bvh
from numpy_cae.mocap.formats.text_file import MotionFileError
from numpy_cae.mocap.formats.write_bvh import write_bvh
from numpy_cae.mocap.formats.write_like import write_like
from numpy_cae.mocap.retargeting.body import body_of
from numpy_cae.mocap.retargeting.to_angles import angles_of
from numpy_cae.mocap.rigs.recognise import recognised
from numpy_cae.mocap.rigs.rigs import Mappings, RiggedMotion, UnknownRigError
from numpy_cae.motion import AngleSequence, Motion

KEPT = (".bvh", ".amc")
"""In these formats `FileMotion.save` keeps the text of what did not change."""


@dataclass(frozen=True, repr=False, kw_only=True, eq=False)
class FileMotion(RiggedMotion):
    """A motion that was read from a file, and everything made of it by `dataclasses.replace`.

    Parameters
    ----------
    source : path
        The file.
    reload : callable
        Reads the whole file again, as this motion was read.
    """

    source: Path
    reload: Callable[[], Motion]

    def save(self, path: str | Path, before: Motion | None = None) -> None:
        """Write the motion to a file.

        In the format of its own file (.bvh, .amc) the text of everything that did not change is
        kept, byte for byte, also where frames at the start were cut off, and a missing .asf
        skeleton is copied beside an .amc file. A motion of another format, at another rate, or with
        more frames is written as BVH.

        Parameters
        ----------
        path : path
            The file to write: .bvh, or .amc if the source is one. It may be the source.
        before : Motion, optional
            The motion as it was read; the file is read again where None.

        Raises
        ------
        ValueError, FileError
            If the suffix is another, or values are not finite; if the file cannot be written, or
            an .amc file would be read with another skeleton there.
        """
        path = Path(path)
        same_format = self.source.suffix.lower() == path.suffix.lower() in KEPT
        if same_format and before is None:
            before = self.reload()
        if not same_format or before is None or before.rate != self.rate or len(before) < len(self):
            write_bvh(self, path)
            return
        if path.suffix.lower() == ".amc":
            _copy_skeleton(find_skeleton(self.source), path)
        write_like(self.source, before, self, path)


def save(motion: Motion, path: str | Path) -> None:
    """Write any motion to a file, one that was made in memory too.

    Parameters
    ----------
    motion : Motion
        One that was loaded, or made of a loaded one, is written by `FileMotion.save`, which keeps
        the text of everything that did not change. Any other is written by `write_bvh`.
    path : path
        The file to write: .bvh, or .amc if the motion was loaded from one.

    Raises
    ------
    ValueError, FileError
        If the suffix is another, or values are not finite; if the file cannot be written.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import load_motion
    >>> save(make_take("walk", 0, seconds=1.0, rate=30.0).motion, "walk.bvh")
    >>> save(load_motion("walk.bvh").resampled(15), "slower.bvh")
    >>> len(load_motion("slower.bvh"))
    15
    """
    if isinstance(motion, FileMotion):
        motion.save(path)
    else:
        write_bvh(motion, path)


def _copy_skeleton(skeleton: Path, path: Path) -> None:
    """Copy the skeleton of an .amc file beside `path`, where it is not there; FileError unless the
    motion at `path` is then read with it."""
    copy = path.with_name(skeleton.name)
    if not copy.exists():
        with atomic_write(copy) as temporary:
            shutil.copyfile(skeleton, temporary)
    beside = find_skeleton(path)
    if not filecmp.cmp(beside, skeleton, shallow=False):
        problem = f"would be read with another skeleton, {beside}, not with {skeleton}"
        raise FileError(path, None, f"{problem}; write it into another folder")


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
    known are added (`with_added_joints`).

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
    suffix = path.suffix.lower()
    problem = ""
    if os.path.isdir(path):
        problem = f"is a folder, expected one motion file; {SUPPORTED}"
    elif not os.path.exists(path):
        problem = f"there is no such file; {SUPPORTED}"
    elif suffix == ".asf":
        problem = "is a skeleton without motion, expected the .amc file that moves it"
    elif suffix not in SUFFIXES:
        problem = f"{suffix or 'a file without suffix'} is not supported; {SUPPORTED}"
    if problem:
        raise MotionFileError(path, None, problem)
    require_coordinates(unit, up, floor)
    with _naming(path):
        reader = {".amc": read_amc, ".bvh": read_bvh}.get(suffix)
        read = reader(path, unit, max_rate) if reader else read_expmap(path, unit)
        motion = recognised(read, mapping)
        del read
        if suffix == ".bvh" and unit is None:
            motion = with_unit_of_limbs(motion)
        is_odd = any(note.kind != "unit" or note.in_doubt for note in motion.notes)
        motion = in_y_up(motion, up, floor)
    log.log(logging.WARNING if is_odd else logging.INFO, "%s: %s", path, motion.note)
    reload = partial(load_motion, path, unit, None, up, floor, mapping)
    return FileMotion(**vars(motion), source=path, reload=reload)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Name the file in an `UnknownRigError` of the block, and turn any unexpected exception into a
    `MotionFileError` that names it, so that one strange file does not end the reading of thousands.
    """
    try:
        yield
    except UnknownRigError as error:
        raise UnknownRigError(f"{path}: {error}") from None
    except NumpyCaeError:
        raise
    except Exception as error:
        problem = f"cannot be read: {type(error).__name__}: {error}"
        raise MotionFileError(path, None, " ".join(problem.split())) from error


def load_body(path: str | Path, **options: Any) -> tuple[np.ndarray, Motion]:
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
    with _naming(Path(path)):
        return body_of(motion), motion


def load_angles(path: str | Path, **options: Any) -> AngleSequence:
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
    motion = load_motion(path, **options | {"floor": 0.0})
    with _naming(Path(path)):
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
    paths = sorted(
        path
        for path in folder.rglob("*")
        # A name that begins with a dot is a system's note about a file, not the file.
        if path.suffix.lower() in SUFFIXES
        and path.is_file()
        and not path.name.startswith(".")
        and (path.suffix.lower() != ".txt" or is_expmap_text(path))
    )
    if not paths:
        raise MotionFileError(folder, None, f"holds no motion file; {SUPPORTED}")
    return paths


def is_test(path: Path, patterns: Sequence[str]) -> bool:
    """Whether a file's name matches one of the patterns, such as "*_005.bvh"."""
    return any(fnmatch(path.name, pattern) for pattern in patterns)
