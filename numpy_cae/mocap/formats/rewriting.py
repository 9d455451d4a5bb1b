"""Write a changed motion as a copy of its file in which only the changed numbers are replaced.

The header, the order of channels, line ends, spaces and all other numbers are unchanged. The
text is processed in blocks of frames, so that a long file needs little memory.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path
from typing import IO

import numpy as np

from numpy_cae.atomic_write import atomic_write
from numpy_cae.mocap.coordinates import turn_as_in_file
from numpy_cae.mocap.formats.amc import amc_channels
from numpy_cae.mocap.formats.channels import JointChannels, columns_of
from numpy_cae.mocap.formats.read_bvh import bvh_channels
from numpy_cae.mocap.formats.text_file import MotionFileError, as_number
from numpy_cae.motion.masks import runs
from numpy_cae.motion.motion import Motion, require_finite
from numpy_cae.motion.quaternions import angle, inverse, product

log = logging.getLogger(__name__)

_BLOCK = 4096
"""The number of frames that are processed at a time."""
_NOTICEABLE = 0.5
"""A rotation or place that channels change by more than this (°, cm) is reported."""
_FRAMES = re.compile(r"(Frames:\s*)\d+", re.IGNORECASE)
"""The number of frames in the header of a BVH file."""
_GAPS = re.compile(r"(\s+|(?<!\.)#[^\r\n]*)")
"""White space and comments, which separate words; 1.#QNAN is a word."""


def rewrite_numbers(source: str | Path, before: Motion, after: Motion, path: str | Path) -> None:
    """Write `after`, a changed version of `before`, with the text of the file `before` came from.

    Numbers are replaced where a joint's rotation or translation differs between the two. They have
    as many decimals as the file's, and angles continue those of neighbouring frames without
    avoidable jumps. If a joint's channels do not allow its rotation or translation, the nearest one
    that they allow is written, with a warning. `FileMotion.save` calls this where it is possible.

    Parameters
    ----------
    source : path of a .bvh or .amc file
    before : Motion
        The motion that `load_motion(source)` returns.
    after : Motion
        The changed motion, on the same skeleton; of its frames some may be cut off at the start,
        and, where its first and its last frame are unchanged, at the end.
    path : path of the file
        Of the same suffix. Replaced if it exists; it may be `source`.

    Raises
    ------
    MotionFileError
        If the source cannot be read again or has changed.
    ValueError
        If `after` has values that are not finite.
    FileError
        If the file cannot be written.

    Examples
    --------
    If the motion is unchanged, the file that is written has the same bytes:

    >>> from data_synth import make_take
    >>> from numpy_cae.mocap import load_motion, write_bvh
    >>> write_bvh(make_take("walk", 1, seconds=1.0, rate=30.0).motion, "walk.bvh", unit=0.01)
    >>> motion = load_motion("walk.bvh")
    >>> rewrite_numbers("walk.bvh", motion, motion, "same.bvh")
    >>> Path("same.bvh").read_bytes() == Path("walk.bvh").read_bytes()
    True
    """
    source = Path(source)
    require_finite(after)
    is_bvh = source.suffix.lower() == ".bvh"
    channels = bvh_channels(source, before.unit) if is_bvh else amc_channels(source, before.unit)
    replacer = _Replacer(channels, is_bvh)
    with (
        atomic_write(path) as temporary,
        _open_text(source, "r") as lines,
        _open_text(temporary, "w") as output,
    ):
        output.writelines(_write_parts(_parts(lines, is_bvh), replacer, before, after, source))
    if replacer.misses:
        misses = []
        for (joint, unit), miss in replacer.misses.items():
            misses.append(f"{joint} {miss:.0f}{unit}")
        worst = ", ".join(misses)
        log.warning("%s: not written, as the channels do not allow it: %s", path, worst)


def _write_parts(
    parts: Iterator[str], replacer: _Replacer, before: Motion, after: Motion, source: Path
) -> Iterator[str]:
    """The parts of the new file, from those of the source: its header, then each frame that is not
    cut off."""
    header = next(parts)
    if len(before) == len(after):
        yield header
        yield from _replace_frames(parts, replacer, before, after, source)
        return
    yield _FRAMES.sub(rf"\g<1>{len(after)}", header)
    first = _first_frame(before, after)
    end = first + len(after)
    remaining = islice(parts, first, end)
    frames = _replace_frames(remaining, replacer, before.at(slice(first, end)), after, source)
    if replacer.is_bvh:
        yield from frames
        return
    for number, text in enumerate(frames, 1):  # an .amc file numbers its frames
        yield re.sub(r"\d+", str(number), text, count=1)


def _first_frame(before: Motion, after: Motion) -> int:
    """The frame of a motion with which a part of it begins: the one from which on its first and its
    last frame are there unchanged; else only frames at the start are cut off."""
    cut = len(before) - len(after)
    is_first = np.ones(cut + 1, bool)
    for values, part in (
        (before.rotations, after.rotations),
        (before.translations, after.translations),
    ):
        is_first &= (values[: cut + 1] == part[0]).all(axis=(1, 2))
        is_first &= (values[len(values) - cut - 1 :] == part[-1]).all(axis=(1, 2))
    return int(np.argmax(is_first)) if is_first.any() else cut


def _replace_frames(
    texts: Iterator[str], replacer: _Replacer, before: Motion, after: Motion, source: Path
) -> Iterator[str]:
    """The text of each frame, with the numbers of `after`."""
    count = 0
    while block := list(islice(texts, _BLOCK)):
        frames = slice(count, count + len(block))
        count += len(block)
        if count > len(after):
            break
        yield from replacer.replace(block, before.at(frames), after.at(frames))
    if count != len(after):
        raise MotionFileError(source, None, "has changed since it was read")


class _Replacer:
    """Replaces the numbers of what changed in the texts of frames, one block after the other.

    Parameters
    ----------
    channels : JointChannels
    is_bvh : bool
        A frame is then a line of numbers; else it names each bone before its numbers.

    Attributes
    ----------
    columns : list of arrays
        The columns of each joint.
    last : (1, C) array
        The numbers of the last frame of the block before; (0, C) in the first block.
    misses : dict
        What channels do not allow: joint and unit, ° or cm, to the largest amount.
    """

    def __init__(self, channels: JointChannels, is_bvh: bool):
        self.channels = channels
        self.is_bvh = is_bvh
        self.columns = columns_of(channels)
        self.last = np.zeros((0, sum(map(len, self.columns))))
        self.misses: dict[tuple[str, str], float] = {}

    def replace(self, texts: list[str], before: Motion, after: Motion) -> list[str]:
        """The texts of a block of frames, in which the motion was `before`, with new numbers."""
        turned = np.any(before.rotations != after.rotations, axis=-1)
        steps = 100 * np.linalg.norm(before.translations - after.translations, axis=-1)
        changed = np.any(turned | ~(steps <= 0), axis=1)  # a step from a NaN is one, too
        # Changed frames, their neighbours and the last frame are parsed.
        parsed = np.convolve(changed, [True, True, True])[1:-1] > 0
        parsed[-1] = True
        values, places_in = self._parse(texts, np.flatnonzero(parsed).tolist())
        old = values.copy()
        self._put(values, turn_as_in_file(after), turned, steps)
        self.last = values[-1:]
        decimals = _decimals(texts, places_in)
        # What was a NaN is written, too.
        new = changed[:, None] & ~(np.abs(values - old) <= 0.5 * 10.0**-decimals)
        written = map(f"%.{decimals}f".__mod__, values[new].tolist())
        for frame in np.flatnonzero(changed).tolist():
            pieces, _ = _split(texts[frame])
            for column, text in zip(new[frame].nonzero()[0].tolist(), written, strict=False):
                pieces[places_in[frame][column]] = text
            texts[frame] = "".join(pieces)
        return texts

    def _parse(
        self, texts: list[str], frames: list[int]
    ) -> tuple[np.ndarray, dict[int, list[int]]]:
        """The numbers of some frames, (all frames, channels), and for each of these frames the
        places of its numbers among the pieces of its text."""
        width = self.last.shape[1]
        values = np.zeros((len(texts), width))
        places_in = {}
        for frame in frames:
            # Frames are split again later: the words of all of them do not fit in the cache.
            pieces, words = _split(texts[frame])
            places_in[frame] = list(words) if self.is_bvh else self._places(pieces, words)
            if (count := len(places_in[frame])) != width:
                problem = f"a frame has {count} numbers, but had {width} when it was read"
                raise ValueError(problem)
            texts_of_numbers = [pieces[place] for place in places_in[frame]]
            try:
                values[frame] = list(map(float, texts_of_numbers))
            except ValueError:  # such as 1.#QNAN
                values[frame] = list(map(as_number, texts_of_numbers))
        return values, places_in

    def _places(self, pieces: list[str], words: Sequence[int]) -> list[int]:
        """Of the words of a frame, its number, then for each bone the name and the values, the
        places of the values in the order of the columns."""
        places: dict[str, Sequence[int]] = {}
        start = 1
        while start < len(words):
            name = pieces[words[start]]
            end = start + 1 + len(self.channels[name].names)
            places[name] = words[start + 1 : end]
            start = end
        in_order: list[int] = []
        for name in self.channels:
            in_order += places.get(name, ())
        return in_order

    def _put(
        self, values: np.ndarray, after: Motion, turned: np.ndarray, steps: np.ndarray
    ) -> None:
        """Put the numbers of a motion into `values` where a joint turned, or moved by `steps` (cm),
        each (F, J)."""
        for joint, (name, of_joint) in enumerate(self.channels.items()):
            columns = self.columns[joint]
            frames = np.flatnonzero(~(steps[:, joint] <= 0))  # a step from a NaN is one, too
            place = np.ix_(frames, columns[of_joint.places("t")])
            lengths = (after.translations[frames, joint] - of_joint.offset) / of_joint.unit
            values[place] = lengths[:, of_joint.coordinates]
            columns = columns[of_joint.places("r")]
            for first, end in runs(turned[:, joint]):
                rotations = after.rotations[first:end, joint]
                before = values[first - 1 : first] if first else self.last
                angles = of_joint.rotation_values(
                    rotations,
                    present=values[first:end, columns],
                    before=before[:, columns],
                    after=values[end : end + 1, columns],
                )
                values[first:end, columns] = angles
                if len(columns) < 3:
                    misses = angle(product(inverse(of_joint.rotations(angles)), rotations))
                    self._note(name, "°", float(np.degrees(misses.max())))
            if len(of_joint.coordinates) < 3:
                self._note(name, " cm", float(steps[:, joint].max()))

    def _note(self, joint: str, unit: str, miss: float) -> None:
        if miss > _NOTICEABLE:
            self.misses[joint, unit] = max(miss, self.misses.get((joint, unit), 0.0))


def _split(text: str) -> tuple[list[str], Sequence[int]]:
    """A text as pieces, which are words and gaps in turn, and the places of the words among the
    pieces."""
    body = text.strip()
    words = text.split()
    if " ".join(words) == body and "#" not in body:  # most lines; ten times as fast
        pieces = [" "] * (2 * len(words) + 1)
        pieces[1::2] = words
        pieces[0], _, pieces[-1] = text.partition(body)
        return pieces, range(1, len(pieces), 2)
    pieces = _GAPS.split(text)
    return pieces, [place for place in range(0, len(pieces), 2) if pieces[place]]


def _decimals(texts: list[str], places_in: dict[int, list[int]]) -> int:
    """The largest number of decimals in a sample of the frames."""
    words = []
    for frame in islice(places_in, 0, None, max(1, len(places_in) // 50)):
        pieces, _ = _split(texts[frame])
        words += [pieces[place] for place in places_in[frame]]
    plain = (word for word in words if word.lstrip("+-").replace(".", "", 1).isdigit())
    return max((len(word.partition(".")[2]) for word in plain), default=6)


def _open_text(path: Path, mode: str) -> IO[str]:
    # Line ends are not translated, and bytes that are not UTF-8 are written as they were read.
    return path.open(mode, encoding="utf-8", errors="surrogateescape", newline="")


def _parts(lines: Iterable[str], is_bvh: bool) -> Iterator[str]:
    """The text above the first frame, then the text of each frame."""
    # Every line of the header of a BVH file begins with a keyword or a brace.
    begins = re.compile(r"(?i)\s*([-+.\d]|nan|inf)" if is_bvh else r"\s*\d+\s*(#|$)")
    part: list[str] = []
    for line in lines:
        if begins.match(line):
            yield "".join(part)
            part = []
        part.append(line)
    yield "".join(part)
