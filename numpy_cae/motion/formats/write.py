"""Write a motion to any supported file, chosen by its suffix; here as a table of positions."""

from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.motion.axes import without_added
from numpy_cae.motion.formats.bvh_writer import write_bvh
from numpy_cae.motion.motion import Motion


def write_npz(motion: Motion, path: str | Path) -> None:
    """Write `positions` (F, J, 3) in metres, `names`, `parents` and `rate`, atomically."""
    positions, rate = motion.positions(), motion.rate
    names, parents = np.array(motion.skeleton.names), np.array(motion.skeleton.parents)
    with atomic_write(path) as beside, beside.open("wb") as file:
        np.savez_compressed(file, positions=positions, names=names, parents=parents, rate=rate)


def write_csv(motion: Motion, path: str | Path) -> None:
    """Write a row for each frame, atomically: its time in seconds, then x, y and z in metres of
    each joint, with the joints' names in the first row."""
    positions = motion.positions().reshape(len(motion), -1)
    table = np.column_stack([np.arange(len(motion)) / motion.rate, positions])
    names = [name.replace('"', '""') for name in motion.skeleton.names]
    header = ",".join(["time", *(f'"{name} {axis}"' for name in names for axis in "xyz")])
    with atomic_write(path) as beside, beside.open("w", encoding="utf-8", newline="\n") as file:
        np.savetxt(file, table, fmt="%.6f", delimiter=",", header=header, comments="")


WRITERS = {".bvh": write_bvh, ".npz": write_npz, ".csv": write_csv}


def require_writer(path: str | Path) -> None:
    """Raise ValueError if no writer has the suffix of this path."""
    if Path(path).suffix.lower() not in WRITERS:
        known = "a motion is written as .bvh, .npz or .csv (positions)"
        raise ValueError(f"{path}: {known}")


def write_motion(motion: Motion, path: str | Path) -> None:
    """Write a motion as .bvh, .npz or .csv, atomically.

    BVH has the up axis and the floor of the motion's file; the others are Y up with the floor at 0.

    Parameters
    ----------
    motion : Motion
    path : path of the file
        Replaced if it exists; its suffix chooses the format.

    Raises
    ------
    ValueError
        If the suffix is another, or the motion has no frames or values that are not finite.
    FileError
        If the file cannot be written.

    Examples
    --------
    >>> from data_synth import make_take
    >>> write_motion(make_take("walk", 1, seconds=1.0, rate=30.0).motion, "walk.npz")
    >>> np.load("walk.npz")["positions"].shape
    (30, 31, 3)
    """
    require_writer(path)
    WRITERS[Path(path).suffix.lower()](without_added(motion), path)
