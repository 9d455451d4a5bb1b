"""A text file whose lines are numbered, so that every complaint can say where it looked.

BVH, ASF and AMC are all plain text, one statement a line; what they share is here: decoding,
counting lines as an editor does, and numbers that are numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from numpy_cae.motion.error import MotionFileError


@dataclass(frozen=True)
class TextFile:
    """The lines of a file, without their line ends. Line numbers count from 1.

    Parameters
    ----------
    path : pathlib.Path
    lines : list of str
    """

    path: Path
    lines: list[str]

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
        if not data.strip():
            raise MotionFileError(path, None, "the file is empty")
        if b"\0" in data:
            raise MotionFileError(path, None, "is a binary file, expected plain text (UTF-8)")
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            # Only names can hold such letters, and Latin-1 gives every byte a letter.
            text = data.decode("latin-1")
        # splitlines() would also split at letters that are no line end to an editor.
        lines = text.replace("\r\n", "\n").replace("\r", "\n").removesuffix("\n").split("\n")
        return cls(path, lines)

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
        if len(values) < len(words) or "_" in "".join(words) or not all(map(isfinite, values)):
            wrong = next(word for word in words if not _is_number(word))
            raise self.error(line, f"{shortened(wrong)} is not a number, expected a finite number")
        return values

    def three_numbers(self, line: int, words: list[str], what: str) -> list[float]:
        """x, y and z; `what` names them in the error."""
        if len(words) != 3:
            raise self.error(line, f"{what} has {len(words)} values, expected 3 numbers (x y z)")
        return self.numbers(line, words)


def whole_number(text: str) -> int | None:
    """The text as a whole number from 0 up, None where it is none."""
    # No count of anything in a motion file has more digits than this.
    return int(text) if text.isdecimal() and len(text) < 19 else None


def _is_number(word: str) -> bool:
    try:
        return isfinite(float(word)) and "_" not in word
    except ValueError:
        return False


def shortened(text: str) -> str:
    """A quotation that fits into a message, even where a line runs over pages."""
    return repr(text if len(text) <= 60 else text[:57] + "...")
