"""Write a series of takes to a folder, with a subfolder for each person and a table of labels."""

import csv
import io
from collections.abc import Callable, Sequence
from pathlib import Path

from data_synth.series import Plan
from data_synth.take import Take
from numpy_cae.atomic_write import atomic_write
from numpy_cae.mocap import MotionFileError, write_bvh

_CENTIMETRE = 0.01
_COLUMNS = ("file", "kind", "style", "person", "stature_m", "seconds", "rate_hz", "frames", "seed",
            "take")  # fmt: skip


def write_series(
    plans: Sequence[Plan],
    folder: str | Path,
    rate: float = 120.0,
    report: Callable[[Plan, Take], None] | None = None,
) -> Path:
    """Write every planned take, then the labels.

    Files are in centimetres and named as in the CMU database: ``02/02_01.bvh``. A file of the same
    name is replaced; others are left alone.

    Parameters
    ----------
    plans : sequence of Plan
    folder : path
        Created if missing.
    rate : float
        Frames a second.
    report : function, optional
        Called after each take is written.

    Returns
    -------
    Path
        Of ``labels.csv``.

    Raises
    ------
    MotionFileError
        If a file or folder cannot be written.
    """
    folder = Path(folder)
    table = io.StringIO()
    rows = csv.writer(table, lineterminator="\n")
    rows.writerow(_COLUMNS)
    for plan in plans:
        person = f"{plan.person:02d}"
        _make_folder(folder / person)
        take = plan.make(rate)
        path = folder / person / f"{plan.name}.bvh"
        write_bvh(take.motion, path, _CENTIMETRE)
        rows.writerow(
            [path.relative_to(folder).as_posix(), take.kind, take.style, plan.person,
             f"{take.stature:.3f}", f"{take.motion.seconds:.4f}", f"{rate:g}", len(take.motion),
             plan.seed, plan.number]
        )  # fmt: skip
        if report is not None:
            report(plan, take)
    labels = folder / "labels.csv"
    with atomic_write(labels) as beside:
        beside.write_text(table.getvalue(), encoding="utf-8", newline="\n")
    return labels


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise MotionFileError(folder, None, f"cannot be made: {error.strerror}") from error
