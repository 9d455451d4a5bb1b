"""Any supported motion file, by its suffix."""

from __future__ import annotations

import os
from pathlib import Path

from numpy_cae.motion.error import MotionFileError
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.read_amc import read_amc
from numpy_cae.motion.read_bvh import read_bvh

SUPPORTED = "supported are .bvh (BVH) and .amc (Acclaim, its skeleton in an .asf file beside it)"


def load_motion(
    path: str | Path, unit: float | None = None, skeleton: str | Path | None = None
) -> Motion:
    """Read a motion from any supported file.

    Parameters
    ----------
    path : path of a .bvh or .amc file
    unit : float, optional
        Metres in one unit of length of the file, such as 0.01 for centimetres. By default guessed
        for BVH and as the skeleton says for Acclaim; see `Motion.unit_note`.
    skeleton : path, optional
        The .asf file of an .amc file; by default looked for beside it.

    Returns
    -------
    Motion
        `Motion.positions()` gives (frames, joints, 3) in metres.

    Raises
    ------
    MotionFileError
        If the file is missing, damaged or of a kind that is not supported.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if os.path.isdir(path):
        raise MotionFileError(path, None, f"is a folder, expected one motion file; {SUPPORTED}")
    if not os.path.exists(path):
        raise MotionFileError(path, None, f"there is no such file; {SUPPORTED}")
    if suffix == ".asf":
        raise MotionFileError(
            path, None, "is a skeleton without motion, expected the .amc file that moves it"
        )
    if suffix == ".amc":
        return read_amc(path, skeleton, unit=unit)
    if suffix != ".bvh":
        raise MotionFileError(
            path, None, f"{suffix or 'a file without suffix'} is not supported; {SUPPORTED}"
        )
    if skeleton is not None:
        raise MotionFileError(
            path, None, "a BVH file holds its own skeleton, expected no .asf file"
        )
    return read_bvh(path, unit)


def find_motion_files(folder: str | Path) -> list[Path]:
    """Every .bvh and .amc file in a folder and the folders inside it, sorted.

    Raises
    ------
    MotionFileError
        If there is no such folder or it holds no such file.
    """
    folder = Path(folder)
    if not folder.is_dir():
        raise MotionFileError(folder, None, "there is no such folder")
    found = sorted(
        path
        for path in folder.rglob("*")
        # A name that begins with a dot is a system's note about a file, not the file.
        if path.suffix.lower() in (".bvh", ".amc")
        and path.is_file()
        and not path.name.startswith(".")
    )
    if not found:
        raise MotionFileError(folder, None, f"holds no motion file; {SUPPORTED}")
    return found
