"""Read exponential-map text (.txt): comma separated, one frame a line, CMU's or Human3.6M's.

An exponential map is a rotation vector: its length is the angle, its direction the axis. This text
is of people who multiply rows with matrices, so that its matrices are the transposed of ours:

    R = exp([v]×)ᵀ = exp(-[v]×)

The first frame of CMU's text shows it: the T-pose turns the left thigh by -21° about z in BVH,
and the text says +0.3665.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from numpy_cae.motion.io.cmu_root import true_root
from numpy_cae.motion.io.error import MotionFileError
from numpy_cae.motion.io.expmap_rigs import CMU, RIGS_OF_TEXT, ExpmapRig
from numpy_cae.motion.io.text_file import TextFile
from numpy_cae.motion.io.units import require_unit, unit_name
from numpy_cae.motion.motion import Motion

EXPECTED = " or ".join(f"{rig.width} ({rig.name})" for rig in RIGS_OF_TEXT)

_LONG = 40
"""Commas in a line that no sentence has."""


def read_expmap(path: str | Path, unit: float | None = None, rate: float | None = None) -> Motion:
    """Read exponential-map text; which layout it has follows from the length of its lines.

    Parameters
    ----------
    path : path of the .txt file
    unit : float, optional
        Metres in one unit of length; by default CMU's unit or Human3.6M's millimetre.
    rate : float, optional
        Frames a second, which the text does not say; by default 120 for CMU, 50 for Human3.6M.

    Returns
    -------
    Motion
        On the rig's standard bones: the text holds no lengths.

    Raises
    ------
    MotionFileError
        If a line has too few or too many numbers, or something that is no number.
    ValueError
        If `rate` or `unit` is not above 0.
    """
    if rate is not None and not (np.isfinite(rate) and rate > 0):
        raise ValueError(f"rate is {rate}, expected frames a second above 0")
    rig, values = _table(TextFile.read(path))
    metres = rig.unit if unit is None else require_unit(unit)
    # The bones are ours and in metres already; a unit that is given is of the translation alone.
    translations = np.tile(rig.skeleton.offsets, (len(values), 1, 1))
    translations[:, 0] = values[:, :3] * metres
    vectors = values[:, 3:].reshape(len(values), -1, 3)[:, rig.joints]
    rotations = Rotation.from_rotvec(-vectors.reshape(-1, 3)).as_quat()
    rotations = rotations.reshape(len(values), -1, 4)
    if rig is CMU:
        rotations[:, 0] = true_root(Rotation.from_quat(rotations[:, 0])).as_quat()
    return Motion(
        rig.skeleton,
        float(rate or rig.rate),
        rotations,
        translations,
        metres,
        f"{unit_name(metres)} ({'of such text' if unit is None else 'as given'}, {rig.name}; "
        "the bones are a standard person's)",
    )


def is_expmap_text(path: str | Path) -> bool:
    """Whether a text file begins with a long row between commas: a .txt file among motions is as
    often a licence or a note. A row of the wrong length counts: `read_expmap` says what is wrong.
    """
    try:
        with open(path, encoding="latin-1") as file:
            first = next((line for line in file if line.strip()), "")
    except OSError:
        return False
    return first.count(",") > _LONG


def _table(file: TextFile) -> tuple[ExpmapRig, np.ndarray]:
    """The layout, and the numbers (frames, width)."""
    rig, rows = None, []
    for line, text in file.numbered():
        if not text.strip():
            continue
        words = [word.strip() for word in text.split(",")]
        if rig is None:
            rig = next((rig for rig in RIGS_OF_TEXT if rig.width == len(words)), None)
            if rig is None:
                raise file.error(line, f"{_count(words)}, expected {EXPECTED}, separated by commas")
        if len(words) != rig.width:
            raise file.error(line, f"{_count(words)}, expected {rig.width} as in the lines above")
        rows.append(file.numbers(line, words))
    if rig is None:
        raise MotionFileError(file.path, None, "holds no frame")
    return rig, np.array(rows)


def _count(words: list[str]) -> str:
    return f"the line has {len(words)} value{'s' * (len(words) != 1)}"
