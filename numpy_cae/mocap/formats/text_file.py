"""A text file with numbered lines: decoding, numbers and errors, shared by every format."""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from numpy_cae.errors import FileError
from numpy_cae.motion.motion import RATE, Note

MAX_VALUE = 1e12
"""A number of this size or more is refused. No length or angle of a motion is as large, and sums
and products of smaller numbers are finite."""
HEADER_SIZE = 1 << 22
"""So many bytes at the start of a file contain its whole header."""
MAX_BYTES = 1 << 30
"""A longer file is refused."""
MAX_LINE = 1_000_000
"""A line of more characters is refused; a file is decoded in blocks of this size."""
_GLUED = re.compile(r"[+-]?\d*\.?\d+[+-]\d*\.?\d*|[+-]?\d*\.\d+\.\d+")
"""Two numbers between which a blank is missing, such as 0.0-7.5."""
_LOST = re.compile(r"[-+]?(nan\(.*\)|inf(inity)?|1\.#(qnan|snan|ind|inf)\d*)", re.IGNORECASE)
"""Besides "nan", programs write these words for a value that is lost or was divided by zero."""
MAX_JOINTS = 5_000
"""A skeleton with more joints is refused."""


class MotionFileError(FileError):
    """A motion file cannot be read; the message has the file, the line and what was expected."""


@dataclass(frozen=True)
class TextFile:
    """The lines of a file, counted from 1; `data` is UTF-8 with newlines between them."""

    path: Path
    data: bytes

    @classmethod
    def read(cls, path: str | Path, most: int = MAX_BYTES, header: bool = False) -> TextFile:
        """Read a file, or its `header` alone, with any line ends and any byte order mark.

        Raises MotionFileError if it is no regular file, is empty, not text or longer than `most`.
        """
        path = Path(path)
        try:
            bytes_in_all = path.stat().st_size
            if not path.is_file() or bytes_in_all > most:
                problem = f"has {bytes_in_all} bytes, expected a regular file of at most {most}"
                raise MotionFileError(path, None, problem)
            with path.open("rb") as file:
                data = file.read(HEADER_SIZE if header else -1)
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
        if b"\r" in data:
            data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        return cls(path, data)

    @property
    def count(self) -> int:
        """Number of lines."""
        return self.data.count(b"\n") + (not self.data.endswith(b"\n"))

    def numbered_lines(self, after: int = 0) -> Iterator[tuple[int, str]]:
        """(line number, text) of the lines below line `after`."""
        for first, texts in self._blocks():
            yield from ((line, text) for line, text in enumerate(texts, first) if line > after)

    def _blocks(self) -> Iterator[tuple[int, list[str]]]:
        """Blocks of about a megabyte, decoded one at a time: the number of the first line of each,
        and the texts of its lines."""
        start = 0
        line = 1
        while start < len(self.data):
            end = len(self.data)
            if end - start > MAX_LINE:
                end = self.data.rfind(b"\n", start, start + MAX_LINE + 1) + 1
            if end == 0:
                length = (self.data + b"\n").index(b"\n", start) - start
                problem = f"the line has {length} characters, expected at most {MAX_LINE}"
                raise self.error(line, problem)
            texts = self.data[start:end].decode().removesuffix("\n").split("\n")
            yield line, texts
            start = end
            line += len(texts)

    def error(self, line: int | None, problem: str) -> MotionFileError:
        """An error about a line of this file, for the caller to raise."""
        return MotionFileError(self.path, line, problem)

    def numbers(
        self, line: int, words: list[str], count: int | None = None, name: str = ""
    ) -> list[float]:
        """The words as numbers: finite ones if they are `count` numbers of `name`, else also NaN.

        MotionFileError quotes the first word that is not such a number, or says how many values
        `name` has.
        """
        if count is not None and len(words) != count:
            problem = f"{name} has {len(words)} {'value' if len(words) == 1 else 'values'}"
            expected = "number" if count == 1 else "numbers"
            raise self.error(line, f"{problem}, expected {count} {expected}")
        values = []
        for word in words:
            value = as_number(word)
            if value is None or (count is not None and np.isnan(value)):
                problem = f"{quote(word)} is not a number"
                if "," in word and as_number(word.replace(",", ".")) is not None:
                    raise self.error(line, f"{problem}: write decimals with a point, not a comma")
                raise self.error(line, f"{problem}, expected a finite number below {MAX_VALUE:g}")
            values.append(value)
        return values

    def table(
        self, after: int, width: int, expected: str, step: int = 1, separator: str | None = None
    ) -> tuple[np.ndarray, int]:
        """The numbers in every `step`-th of the lines below line `after`, (rows, width) of float64,
        and the number of these lines; blank lines are left out.

        The last line is parsed too, as it may be cut off; the others are only counted. `expected`
        describes a line in an error. Numbers are separated by `separator`, None for white space.
        """
        rows = [np.empty((0, width))]
        lines = 0
        last: list[tuple[int, str]] = []
        for first, texts in self._blocks():
            numbered = enumerate(texts, first)
            filled = [(line, text) for line, text in numbered if line > after and text.strip()]
            parsed = filled[-lines % step :: step]
            if parsed:
                rows.append(self._rows(parsed, width, expected, separator))
            lines += len(filled)
            last = filled[-1:] or last
        if last and step > 1:
            self._rows(last, width, expected, separator)
        return np.concatenate(rows), lines

    def _rows(
        self, lines: list[tuple[int, str]], width: int, expected: str, separator: str | None
    ) -> np.ndarray:
        """The numbers (lines, width) in lines given as (line number, text)."""
        with suppress(ValueError):
            texts = [text for _, text in lines]
            values = np.loadtxt(texts, comments=None, ndmin=2, delimiter=separator)
            # A NaN fails no comparison.
            if values.shape == (len(lines), width) and not (np.abs(values) >= MAX_VALUE).any():
                return values
        # A line is damaged, or its digits are not ASCII: float() reads those, np.loadtxt does not.
        rows = []
        for line, text in lines:
            words = text.split(separator)
            if len(words) != width:
                problem = f"{len(words)} values, expected {width}: {expected}"
                glued = next((word for word in words if _GLUED.fullmatch(word.strip())), "")
                if glued:
                    problem += f"; {quote(glued)} is two numbers without a blank between them"
                raise self.error(line, problem)
            rows.append(self.numbers(line, [word.strip() for word in words]))
        return np.array(rows)

    def lost_values(self, values: np.ndarray) -> list[Note]:
        """A note if frames of a table (frames, values) have a NaN; MotionFileError if all do."""
        lost = np.flatnonzero(np.isnan(values.sum(axis=1)))
        if len(lost) == len(values):
            raise self.error(None, "every frame has a value that is not a number")
        text = f"values are not numbers (nan) in {len(lost)} frames, the first is frame "
        return [Note("lost values", f"{text}{lost[0]}")] if len(lost) else []

    def require_frames(self, frames: int, joints: int, rate: float) -> None:
        """Reject more joint rotations than a file of this size can describe, before it is parsed.

        A joint without channels takes memory but no space in the file, and a frame of a low rate
        becomes many frames when it is resampled to `RATE`.
        """
        count = frames * joints * max(1.0, RATE / rate)
        most = min(100_000 + 4 * len(self.data), 1_000_000 + len(self.data) // 12)
        if count > most:
            problem = f"{frames} frames of {joints} joints are {count:.0f} joint rotations"
            expected = f"expected at most {most} in a file of this size"
            raise self.error(None, f"{problem} at {RATE:g} a second or more, {expected}")


def whole_number(text: str) -> int | None:
    """The text as a non-negative integer; None if it is something else."""
    # No count in a motion file has 19 digits.
    return int(text) if text.isdecimal() and len(text) < 19 else None


def quote(text: str) -> str:
    """The text in quotation marks, shortened to fit in a message."""
    return repr(text if len(text) <= 60 else text[:57] + "...")


def as_number(word: str) -> float | None:
    """The word as a number below `MAX_VALUE` or NaN; None if it is something else."""
    try:
        value = float(word)
    except ValueError:
        return np.nan if _LOST.fullmatch(word) else None
    if value != value or _LOST.fullmatch(word):
        return np.nan
    # float() reads 1_000 too, but a file that has it is damaged.
    return value if abs(value) < MAX_VALUE and "_" not in word else None
