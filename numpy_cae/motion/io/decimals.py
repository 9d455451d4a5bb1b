"""Decimal numbers of many lines, by arithmetic on their bytes: what `float` says of each word, to
the bit, several times as fast.

Eight digits are the eight bytes of one whole number. Neighbours are joined three times, the left
one times 10, then the left pair times 100, then the left four times 10000, in every number of a
text at once (Lemire, Number Parsing at a Gigabyte per Second, 2021):

    1 2 3 4 5 6 7 8  ->  12 34 56 78  ->  1234 5678  ->  12345678

A number with k digits behind its point is (before · 10^k + behind) / 10^k. Both sides are exact in
float64 below 2^53 and 10^22, and a division rounds correctly (Clinger, How to Read Floating Point
Numbers Accurately, 1990). Longer numbers and those with an exponent are handed to `float`.
"""

from __future__ import annotations

import numpy as np

BLOCK = 1 << 18
"""Letters at a time, so that what is made of them stays close to the processor."""
DIGITS = 8
"""At most before the point, and as many behind it, without asking `float`."""

_SPACE, _TAB, _NEWLINE, _DOT, _PLUS, _MINUS, _ZERO = b" \t\n.+-0"
_TENS = 10 ** np.arange(DIGITS + 1)
_EXACT_TENS = _TENS.astype(float)
_KEPT = np.array([sum(15 << 8 * (7 - place) for place in range(n)) for n in range(9)], np.uint64)
"""[n] keeps the last n of eight bytes, of each "0" to "9" its four low bits: 0 to 9. The first of
eight letters is the lowest byte."""

_LANES = {
    8: np.uint64(0x00FF00FF00FF00FF),
    16: np.uint64(0x0000FFFF0000FFFF),
    32: np.uint64(0x00000000FFFFFFFF),
}
"""Where the left one of each two neighbours of so many bits stands."""


def decimals(text: bytes, width: int, start: int = 0) -> np.ndarray | None:
    """The numbers of a text, as many in each line.

    Parameters
    ----------
    text : bytes
        Lines with a newline between each two; behind the last one may be blanks.
    width : int
        Numbers in a line, between spaces and tabs.
    start : int
        Where in the text they begin.

    Returns
    -------
    (lines, width) array of float64, or None
        None where a line has fewer words or more, where one is no number, and where a letter is
        not of ASCII or is blank without being a space, a tab or a newline.
    """
    stop = len(text)
    while stop > start and text[stop - 1] in b" \t\n":
        stop -= 1
    lines = text.count(b"\n", start, stop) + 1
    # A digit and a blank for each number at least: no room is made for more than can be there.
    if stop - start + 1 < 2 * width * lines:
        return None
    values = np.empty((lines, width))
    row = 0
    while start < stop:
        end = text.find(b"\n", start + BLOCK, stop)
        end = stop if end < 0 else end
        block = _numbers(b" " * (DIGITS + 1) + text[start:end] + b"\n", width)
        if block is None:
            return None
        values[row : row + len(block)] = block
        start, row = end + 1, row + len(block)
    return values


def a_word_at_a_time(text: str, width: int) -> np.ndarray | None:
    """The readable twin of `decimals`, to which tests hold it equal."""
    rows = [line.split() for line in text.rstrip().split("\n")]
    # Python reads 1_000 as a number; a motion file that says so is damaged.
    if any(len(words) != width for words in rows) or "_" in text:
        return None
    try:
        return np.array([[float(word) for word in words] for words in rows])
    except ValueError:
        return None


def _numbers(text: bytes, width: int) -> np.ndarray | None:
    """(lines, width) numbers of a text that begins with nine spaces and ends with a newline."""
    letters = np.frombuffer(text, np.uint8)[DIGITS:]
    marks = np.flatnonzero((letters <= _SPACE) | (letters == _DOT))
    words = _words(letters, marks, width)
    if words is None:
        return None
    starts, points, ends = words
    first = letters[starts]
    negative = first == _MINUS
    signed = negative | (first == _PLUS)
    before = points - starts - signed
    behind = np.maximum(ends - points - 1, 0)

    # [i] is the eight bytes before letter i.
    eight = np.ndarray(len(letters), np.dtype("<u8"), text, strides=(1,)).copy()
    places = np.minimum(behind, DIGITS)
    digits = _joined(eight[points] & _KEPT[np.minimum(before, DIGITS)])
    digits *= _TENS[places]
    digits += _joined(eight[ends] & _KEPT[places])
    values = digits.astype(float) / _EXACT_TENS[places]
    values = np.where(negative, -values, values)

    odd = (before > DIGITS) | (behind > DIGITS) | (before + behind == 0) | (digits >= 1 << 53)
    is_digit = letters - np.uint8(_ZERO) < 10
    if np.count_nonzero(is_digit) + np.count_nonzero(signed) + len(marks) < len(letters):
        others = ~is_digit
        others[marks] = others[starts[signed]] = False
        odd[np.searchsorted(ends, np.flatnonzero(others))] = True
    if odd.any():
        bounds = np.stack([starts[odd], ends[odd]], axis=1) + DIGITS
        words = [text[start:end] for start, end in bounds.tolist()]
        try:
            values[odd] = [float(word) for word in words]
        except ValueError:
            return None
        if any(b"_" in word for word in words):
            return None
    return values.reshape(-1, width)


def _words(
    letters: np.ndarray, marks: np.ndarray, width: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Where each word starts, has its point (its end where it has none) and ends.

    `marks` are the places of blanks and points. None unless each line has `width` words.
    """
    kinds = letters[marks]
    newlines = marks[kinds == _NEWLINE]
    if np.count_nonzero(kinds < _SPACE) > len(newlines) + np.count_nonzero(kinds == _TAB):
        return None
    blanks = np.flatnonzero(kinds != _DOT)
    dots = np.diff(blanks) - 1
    if dots.max() > 1:
        return None
    bounds = marks[blanks]
    starts, ends = bounds[:-1] + 1, bounds[1:]
    points = np.where(dots, marks[blanks[1:] - 1], ends)
    filled = ends > starts
    if not filled.all():
        starts, points, ends = starts[filled], points[filled], ends[filled]
    words = np.searchsorted(ends, newlines, side="right")
    if (words != width * np.arange(1, len(newlines) + 1)).any():
        return None
    return starts, points, ends


def _joined(digits: np.ndarray) -> np.ndarray:
    """Eight bytes, each a digit, as one number (N,) of int64; see the top of this file."""
    for bits, tens in ((8, 10), (16, 100), (32, 10000)):
        right = digits >> np.uint64(bits)
        digits = digits * np.uint64(tens)
        digits += right
        digits &= _LANES[bits]
    return digits.view(np.int64)
