"""A text file with numbered lines: decoding, numbers and errors, shared by every format."""

from __future__ import annotations

from codecs import BOM_UTF8
from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np

from numpy_cae.motion.io.error import MotionFileError

MAX_VALUE = 1e12
"""Above every length and angle of a motion; sums and products of smaller numbers are finite."""
MIN_RATE = 1.0
"""Frames a second. At lower rates a few frames would last hours and, resampled, fill the memory."""


@dataclass(frozen=True)
class TextFile:
    """The lines of a file, without their line ends. Line numbers count from 1.

    Parameters
    ----------
    path : pathlib.Path
    data : bytes
        UTF-8, with newlines between the lines.
    """

    path: Path
    data: bytes

    @classmethod
    def read(cls, path: str | Path) -> TextFile:
        """Read a file with any line ends, with or without a byte order mark.

        Raises MotionFileError if the file is missing, a folder, empty or not text.
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
                # Only names can hold such characters, and Latin-1 decodes every byte.
                data = data.decode("latin-1").encode()
        return cls(path, data.replace(b"\r\n", b"\n").replace(b"\r", b"\n"))

    @property
    def count(self) -> int:
        """Number of lines."""
        return self.data.count(b"\n") + (not self.data.endswith(b"\n"))

    def numbered(self, after: int = 0) -> Iterator[tuple[int, str]]:
        """(line number, text) of the lines below line `after`, decoded one at a time."""
        line, start = 0, 0
        while start < len(self.data):
            line += 1
            end = self.data.find(b"\n", start)
            end = len(self.data) if end < 0 else end
            if line > after:
                yield line, self.data[start:end].decode()
            start = end + 1

    def error(self, line: int | None, problem: str) -> MotionFileError:
        """An error about a line of this file, for the caller to raise."""
        return MotionFileError(self.path, line, problem)

    def numbers(self, line: int, words: list[str]) -> list[float]:
        """The words as finite numbers.

        Raises MotionFileError quoting the first word that is not a number.
        """
        try:
            values = list(map(float, words))
        except ValueError:
            values = []
        # Python reads 1_000 as a number; a motion file that holds it is damaged.
        if len(values) < len(words) or not _all_usable(values) or "_" in "".join(words):
            wrong = next(word for word in words if not _is_number(word))
            raise self.error(
                line,
                f"{quoted(wrong)} is not a number, expected a finite number below {MAX_VALUE:g}",
            )
        return values

    def three_numbers(self, line: int, words: list[str], name: str) -> list[float]:
        """x, y and z; `name` appears in the error."""
        if len(words) != 3:
            raise self.error(line, f"{name} has {len(words)} values, expected 3 numbers (x y z)")
        return self.numbers(line, words)

    def table(self, after: int, width: int, expected: str, step: int) -> tuple[np.ndarray, int]:
        """The numbers in the lines below line `after`, the same count in each line.

        Parameters
        ----------
        after : int
        width : int
            Numbers in a line.
        expected : str
            Description of a line, for the error.
        step : int
            Only every `step`-th line is parsed; the others are counted.

        Returns
        -------
        (rows, width) array of float64
        lines : int
            Lines that are not blank, parsed or not.
        """
        rows, lines = [], 0
        for line, text in self.numbered(after):
            if not text.strip():
                continue
            if lines % step == 0:
                words = text.split()
                if len(words) != width:
                    raise self.error(line, f"{len(words)} values, expected {width}: {expected}")
                rows.append(np.array(self.numbers(line, words)))
            lines += 1
        return np.array(rows).reshape(-1, width), lines

    def require_meaningful_size(self, frames: int, joints: int) -> None:
        """Reject more poses than a file of this size can describe.

        A joint without channels takes no space in the file, but a quaternion per frame in memory:
        a small damaged file with many such joints and many short lines would fill the memory.
        """
        if frames * joints > 4 * len(self.data) + 100_000:
            raise self.error(
                None,
                f"{frames} frames of {joints} joints, of which almost none has values: expected a "
                "motion",
            )


def whole_number(text: str) -> int | None:
    """The text as a non-negative integer, None if it is none."""
    # Counts in motion files have fewer than 19 digits.
    return int(text) if text.isdecimal() and len(text) < 19 else None


def quoted(text: str) -> str:
    """The text in quotation marks, shortened to fit into a message."""
    return repr(text if len(text) <= 60 else text[:57] + "...")


def _all_usable(values: list[float]) -> bool:
    # A NaN makes the sum NaN, whatever max and min say of it.
    return not values or (
        isfinite(sum(values)) and max(values) < MAX_VALUE and min(values) > -MAX_VALUE
    )


def _is_number(word: str) -> bool:
    try:
        return _all_usable([float(word)]) and "_" not in word
    except ValueError:
        return False
