"""How fast motion files are read, in megabytes a second, beside what else reads them in Python.

Every reader is timed in turns with the others, in processor time. What they bring differs: ours
brings quaternions, translations and a checked file; pybvh brings angles as an array; bvh the words
of each line, which are made numbers here. The package index has no AMC reader; the usual one is a
script that splits each line and calls `float` on its words, which is what stands here for it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.motion import load_motion
from numpy_cae.motion.body import RATE


@dataclass(frozen=True)
class Reading:
    """One reader on one file.

    Parameters
    ----------
    file : str
    reader : str
    speed : float
        Megabytes a second, of the fastest round.
    """

    file: str
    reader: str
    speed: float

    def text(self) -> str:
        """A row of the table."""
        return f"| {self.file} | {self.reader} | {self.speed:.1f} |"


HEADER = "| file | reader | MB/s |\n|---|---|--:|"


def readings(paths: Sequence[Path], rounds: int = 5) -> list[Reading]:
    """Every reader that is installed, on every file; a reader that refuses a file is left out."""
    return [each for path in paths for each in _of(path, rounds)]


def _of(path: Path, rounds: int) -> list[Reading]:
    size = path.stat().st_size / 1e6
    readers = {
        "numpy_cae": load_motion,
        f"numpy_cae, the frames that {RATE:g} Hz needs": lambda p: load_motion(p, wanted=RATE),
    }
    others = _bvh_readers() if path.suffix.lower() == ".bvh" else {"a line at a time": _by_line}
    for name, read in others.items():
        try:
            read(path)
        except Exception:  # whatever a stranger's reader raises of a file that it cannot read
            continue
        readers[name] = read
    best = dict.fromkeys(readers, np.inf)
    for _ in range(rounds):
        for name, read in readers.items():
            best[name] = min(best[name], _seconds(read, path))
    return [Reading(path.name, name, size / seconds) for name, seconds in best.items()]


def _seconds(read: Callable[[Path], object], path: Path) -> float:
    start = time.process_time()
    read(path)
    return time.process_time() - start


def _bvh_readers() -> dict[str, Callable[[Path], object]]:
    readers = {"a line at a time": _by_line}
    try:
        from pybvh import read_bvh_file

        readers["pybvh"] = lambda path: read_bvh_file(str(path))
    except ImportError:
        pass
    try:
        from bvh import Bvh

        readers["bvh"] = lambda path: [
            [float(word) for word in frame] for frame in Bvh(path.read_text()).frames
        ]
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
