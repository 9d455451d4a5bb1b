"""Write the positions of a motion as a table: a NumPy archive (.npz) or text (.csv)."""

from pathlib import Path

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.motion.motion import Motion


def write_npz(motion: Motion, path: str | Path) -> None:
    """Write `positions` (F, J, 3) in metres, `names`, `parents` and `rate`, atomically."""
    names = np.array(motion.skeleton.names)
    parents = np.array(motion.skeleton.parents)
    with atomic_write(path) as beside, beside.open("wb") as file:
        np.savez_compressed(
            file, positions=motion.positions(), names=names, parents=parents, rate=motion.rate
        )


def write_csv(motion: Motion, path: str | Path) -> None:
    """Write a row for each frame, atomically: its time in seconds, then x, y and z in metres of
    each joint, with the joints' names in the first row."""
    positions = motion.positions().reshape(len(motion), -1)
    times = np.arange(len(motion)) / motion.rate
    names = [name.replace('"', '""') for name in motion.skeleton.names]
    header = ",".join(["time", *(f'"{name} {axis}"' for name in names for axis in "xyz")])
    with atomic_write(path) as beside, beside.open("w", encoding="utf-8", newline="\n") as file:
        table = np.column_stack([times, positions])
        np.savetxt(file, table, fmt="%.6f", delimiter=",", header=header, comments="")
