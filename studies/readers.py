"""How fast BVH is read and written, beside packages of the index that are installed.

Each of some rounds reads a file with every package in turn, the files are then written in the same
way, and the figures are medians of processor time. So all packages meet the same load of the
machine.

    pip install pybvh bvh
    python -m studies readers
"""

import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path

from numpy_cae.mocap import load_motion, write_bvh
from studies.costs import write_walk
from studies.shared.result import Result, Table
from studies.timing.alternately import time_alternately

SECONDS = (300.0, 80 / 30)
"""Lengths of the files (s), 30 frames a second of 31 joints."""
READERS = {"pybvh": "read_bvh_file", "bvhio": "readAsBvh", "bvhtoolbox": "BvhTree", "bvh": "Bvh"}
"""Packages of the index and their functions; the last two take the text of a file."""
WRITERS = {"pybvh": "write_bvh_file"}
Work = Callable[[], object]


def run(rounds: int = 15) -> Result:
    """Read and write two files with every package that is installed."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        paths = [write_walk(folder / f"{seconds:.0f}.bvh", seconds) for seconds in SECONDS]
        rows = [row for path in paths for row in _rows(path, folder / "out.bvh", rounds)]
    header = ["file, MB", "package", "read, ms", "read, MB/s", "written, ms", "written, MB/s"]
    return Result("Readers", [Table("", header, rows, (".2f", "", ".1f", ".1f", ".1f", ".1f"))])


def _rows(path: Path, out: Path, rounds: int) -> Iterator[list[object]]:
    """The size of a file, then for each package what reading and writing it takes."""
    megabytes = path.stat().st_size / 1e6
    readers: dict[str, Work] = {"numpy_cae": partial(load_motion, path)}
    writers: dict[str, Work] = {"numpy_cae": partial(write_bvh, load_motion(path), out)}
    for package, function in READERS.items():
        with suppress(ImportError):
            source = path.read_text() if package in ("bvhtoolbox", "bvh") else str(path)
            readers[package] = partial(getattr(import_module(package), function), source)
    for package in WRITERS.keys() & readers.keys():
        write = getattr(import_module(package), WRITERS[package])
        writers[package] = partial(write, readers[package](), out)
    read = time_alternately(readers, rounds, time.process_time)
    written = time_alternately(writers, rounds, time.process_time)
    for package, timing in read.items():
        seconds = timing.median
        row: list[object] = [megabytes, package, 1e3 * seconds, megabytes / seconds, None, None]
        if package in written:
            seconds = written[package].median
            row[4:] = [1e3 * seconds, megabytes / seconds]
        yield row
