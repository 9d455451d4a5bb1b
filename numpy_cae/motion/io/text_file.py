"""A text file whose lines are numbered, so that every complaint can say where it looked.

BVH, ASF and AMC are all plain text, one statement a line; what they share is here: decoding,
counting lines as an editor does, and numbers that are numbers.
"""

from __future__ import annotations

from codecs import BOM_UTF8
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import isfinite
from pathlib import Path

import numpy as np

from numpy_cae.motion.io.decimals import decimals
from numpy_cae.motion.io.error import MotionFileError

LARGEST = 1e12
"""No length and no angle of a motion is as large; sums and products of such numbers are finite."""
SLOWEST = 1.0
"""Frames a second. Below it a few frames would be hours, and at 30 a second fill the memory."""


@dataclass(frozen=True)
class TextFile:
    """The lines of a file, without their line ends. Line numbers count from 1.

    Parameters
    ----------
    path : pathlib.Path
    data : bytes
        UTF-8, a newline between each two lines and at most one behind the last.
    """

    path: Path
    data: bytes

    @classmethod
    def read(cls, path: str | Path) -> TextFile:
        """Read a file, whatever its line ends, with or without a byte order mark.

        Raises
        ------
        MotionFileError
            If the file is missing, a folder, empty or not text.
        """
        path = Path(path)
        try:
            data = path.read_bytes()
        except FileNotFoundError:
            raise MotionFileError(path, None, "there is no such file") from None
        except IsADirectoryError:
            raise MotionFileError(path, None, "is a folder, expected a file") from None
        except OSError as error:
            raise MotionFileError(path, None, f"cannot be read: {error.strerror}") from None
        if not data or data.isspace():
            raise MotionFileError(path, None, "the file is empty")
        if b"\0" in data:
            raise MotionFileError(path, None, "is a binary file, expected plain text (UTF-8)")
        if not data.isascii():
            data = data.removeprefix(BOM_UTF8)
            try:
                data.decode()
            except UnicodeDecodeError:
                # Only names can hold such letters, and Latin-1 gives every byte a letter.
                data = data.decode("latin-1").encode()
        if b"\r" in data:
            data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        return cls(path, data)

    @cached_property
    def lines(self) -> list[str]:
        """All of them at once."""
        # splitlines() would also split at letters that are no line end to an editor.
        return self.data.decode().removesuffix("\n").split("\n")

    @property
    def count(self) -> int:
        """How many lines there are."""
        return self.data.count(b"\n") + (not self.data.endswith(b"\n"))

    def numbered(self, after: int = 0) -> Iterator[tuple[int, str]]:
        """The lines below a line one by one, each with its number: the beginning of a large file
        costs no more than that of a small one."""
        bounds = self._bounds(self._start(after))
        for line, (start, end) in enumerate(bounds, start=after + 1):
            yield line, self.data[start:end].decode()

    def _bounds(self, start: int) -> Iterator[tuple[int, int]]:
        """Where in the data each line begins and ends, the first of them at `start`."""
        while start < len(self.data):
            end = self.data.find(b"\n", start)
            end = len(self.data) if end < 0 else end
            yield start, end
            start = end + 1

    def _start(self, after: int) -> int:
        """Where in the data the line after this one begins."""
        start = 0
        for _ in range(after):
            start = self.data.find(b"\n", start) + 1 or len(self.data)
        return start

    def error(self, line: int | None, problem: str) -> MotionFileError:
        """The error to raise for what stands on a line of this file."""
        return MotionFileError(self.path, line, problem)

    def numbers(self, line: int, words: list[str]) -> list[float]:
        """The words as finite numbers.

        Raises
        ------
        MotionFileError
            Naming the first word that is none.
        """
        try:
            values = [float(word) for word in words]
        except ValueError:
            values = []
        # Python reads 1_000 as a number; a motion file that says so is damaged.
        if len(values) < len(words) or "_" in "".join(words) or not all(map(_is_usable, values)):
            wrong = next(word for word in words if not _is_number(word))
            raise self.error(
                line,
                f"{shortened(wrong)} is not a number, expected a finite number below {LARGEST:g}",
            )
        return values

    def table(self, first: int, width: int, expected: str, step: int = 1) -> tuple[np.ndarray, int]:
        """The numbers below a line, as many in each line.

        They are parsed all at once; only where that fails is each line looked at by itself, for the
        error to say which.

        Parameters
        ----------
        first : int
            The line above them.
        width : int
            Numbers in a line.
        expected : str
            What a line should be, for the error.
        step : int
            Only every such line is parsed; the others are counted.

        Returns
        -------
        (rows, width) array of float64
        lines : int
            That are not blank, parsed or not.
        """
        quick = self._quick_table(self._start(first), width, step)
        if quick is not None:
            return quick
        rows = [(number, line) for number, line in self.numbered(first) if line.strip()]
        found = []
        for number, line in rows[::step]:
            words = line.split()
            if len(words) != width:
                raise self.error(number, f"{len(words)} values, expected {width}: {expected}")
            found.append(np.array(self.numbers(number, words)))
        return np.array(found).reshape(-1, width), len(rows)

    def _quick_table(self, start: int, width: int, step: int) -> tuple[np.ndarray, int] | None:
        """The same, None where not every line is as it should be."""
        if step == 1:
            # With no blank line above the end there is nothing to pick.
            values = parsed(self.data, width, start)
            if values is not None:
                return values, len(values)
        lines = [self.data[begin:end] for begin, end in self._bounds(start)]
        lines = [line for line in lines if line and not line.isspace()]
        values = parsed(b"\n".join(lines[::step]), width)
        return None if values is None else (values, len(lines))

    def require_meaning(self, frames: int, joints: int) -> None:
        """Refuse more poses than a file of this size can mean.

        A joint that never turns costs nothing in a file and a quaternion a frame in memory: a small
        file with many of them and many short lines would fill it.
        """
        if frames * joints > 4 * len(self.data) + 100_000:
            raise self.error(
                None,
                f"{frames} frames of {joints} joints, of which almost none has values: expected a "
                "motion",
            )

    def three_numbers(self, line: int, words: list[str], what: str) -> list[float]:
        """x, y and z; `what` names them in the error."""
        if len(words) != 3:
            raise self.error(line, f"{what} has {len(words)} values, expected 3 numbers (x y z)")
        return self.numbers(line, words)


def parsed(data: bytes, width: int, start: int = 0) -> np.ndarray | None:
    """Lines as (lines, width) float64 in one go, None where they are anything else."""
    values = decimals(data, width, start)
    # NaN is not below anything either.
    good = values is not None and max(values.max(), -values.min()) < LARGEST
    return values if good else None


def whole_number(text: str) -> int | None:
    """The text as a whole number from 0 up, None where it is none."""
    # No count of anything in a motion file has more digits than this.
    return int(text) if text.isdecimal() and len(text) < 19 else None


def _is_usable(value: float) -> bool:
    return isfinite(value) and abs(value) < LARGEST


def _is_number(word: str) -> bool:
    try:
        return _is_usable(float(word)) and "_" not in word
    except ValueError:
        return False


def shortened(text: str) -> str:
    """A quotation that fits into a message, even where a line runs over pages."""
    return repr(text if len(text) <= 60 else text[:57] + "...")
