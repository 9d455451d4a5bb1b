"""How fast motion files are read, in megabytes a second, beside what else reads them in Python.

Every reader is timed in turns with the others, in processor time. What each brings differs and
stands beside it: most bring the channels' values, as an array or as lists, our `load_motion` goes
on to quaternions and translations in metres. The readers of others are those that the package index
has (pybvh, bvh, bvhsdk; for AMC asfamc-parser), where they are installed, and the script that
everybody writes, which splits each line and calls `float` on its words.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.motion import load_motion
from numpy_cae.motion.body import RATE
from numpy_cae.motion.read_amc import read_amc_channels
from numpy_cae.motion.read_bvh import read_bvh_channels

OURS = "numpy_cae"
FEWER = f"{OURS}, the frames for {RATE:g} Hz"
LISTS = "values as lists"
ARRAY = "values as an array"
MOTION = "quaternions and translations"

Read = Callable[[Path], object]


@dataclass(frozen=True)
class Reading:
    """One reader on one file.

    Parameters
    ----------
    file : str
    reader : str
    brings : str
        What it makes of the file.
    speed : float
        Megabytes of the file a second, of the fastest round.
    ratio : float
        To the fastest reader of others on this file.
    """

    file: str
    reader: str
    brings: str
    speed: float
    ratio: float

    def text(self) -> str:
        """A row of the table."""
        return (
            f"| {self.file} | {self.reader} | {self.brings} | {self.speed:.1f} | {self.ratio:.2f} |"
        )


HEADER = "| file | reader | brings | MB/s | × fastest other |\n|---|---|---|--:|--:|"


def readings(paths: Sequence[Path], rounds: int) -> list[Reading]:
    """Every reader that is installed, on every file; a reader that refuses a file is left out."""
    return [each for path in paths for each in _of(path, rounds)]


def _of(path: Path, rounds: int) -> list[Reading]:
    is_bvh = path.suffix.lower() == ".bvh"
    channels = read_bvh_channels if is_bvh else read_amc_channels
    readers: dict[tuple[str, str], Read] = {
        (OURS, ARRAY): channels,
        (OURS, MOTION): load_motion,
        (FEWER, ARRAY): lambda path: channels(path, wanted=RATE),
        (FEWER, MOTION): lambda path: load_motion(path, wanted=RATE),
    }
    for name, read in (_bvh_readers() if is_bvh else _amc_readers()).items():
        try:
            read(path)
        except Exception:  # whatever a stranger's reader raises of a file that it cannot read
            continue
        readers[name] = read
    best = dict.fromkeys(readers, np.inf)
    for _ in range(rounds):
        for name, read in readers.items():
            best[name] = min(best[name], _seconds(read, path))
    other = min(seconds for (name, _), seconds in best.items() if not name.startswith(OURS))
    size = path.stat().st_size / 1e6
    return [
        Reading(path.name, name, brings, size / seconds, other / seconds)
        for (name, brings), seconds in best.items()
    ]


def _seconds(read: Read, path: Path) -> float:
    start = time.process_time()
    read(path)
    return time.process_time() - start


def _bvh_readers() -> dict[tuple[str, str], Read]:
    readers: dict[tuple[str, str], Read] = {("a line at a time", LISTS): _by_line}
    try:
        from pybvh import read_bvh_file

        readers["pybvh", ARRAY] = lambda path: read_bvh_file(str(path))
    except ImportError:
        pass
    try:
        from bvhsdk import ReadFile

        readers["bvhsdk", ARRAY] = lambda path: ReadFile(str(path))
    except ImportError:
        pass
    try:
        from bvh import Bvh

        # It brings the words of each line.
        readers["bvh, then `float`", LISTS] = lambda path: [
            [float(word) for word in frame] for frame in Bvh(path.read_text()).frames
        ]
    except ImportError:
        pass
    return readers


def _amc_readers() -> dict[tuple[str, str], Read]:
    readers: dict[tuple[str, str], Read] = {("a line at a time", LISTS): _by_line}
    try:
        from asfamcparser import ParseAMC

        readers["asfamc-parser", LISTS] = lambda path: ParseAMC(str(path))
    except ImportError:
        pass
    return readers


def _by_line(path: Path) -> list[list[float]]:
    """Whatever is a number in each line, one `float` after the other."""
    rows = []
    with open(path, encoding="latin-1") as file:
        for line in file:
            words = line.split()
            try:
                rows.append([float(word) for word in words])
            except ValueError:
                rows.append([float(word) for word in words[1:] if _is_number(word)])
    return rows


def _is_number(word: str) -> bool:
    return word.lstrip("+-")[:1].isdigit() and word[-1].isdigit()
