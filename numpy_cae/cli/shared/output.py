"""Output of the commands: messages on standard error, made visible and laid out."""

import os
import re
import shutil
import sys
import textwrap
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO, TypeVar

from numpy_cae.progress import ProgressLine, hide_progress, time_to_go
from numpy_cae.visible import visible

Item = TypeVar("Item")


BOLD = "\x1b[1m"
RED = "\x1b[1;31m"
YELLOW = "\x1b[33m"
PLAIN = "\x1b[0m"
"""What a terminal takes to print bold, in red or in yellow, and to end that."""
ERROR = re.compile(r"^numpy-cae [^:\n]*:(?=\s)")
"""The beginning of a line that says why a command ended."""
SUBJECT = re.compile(r"^[^\s|][^|\n]*?:(?=\s)")
"""The file or command with which a line begins."""
WARNING = re.compile(
    r"\(worse\)|FAILED|\d+ of \d+ files could not be used|not done yet|left out|not written"
    r"|unlike what the model knows|\d+ proposed, not changed|\d+ found, left alone"
)
"""What a user should not overlook."""


class VisibleStream:
    """A text stream whose writing makes every character visible, whatever names are printed: as an
    escape if the stream's encoding lacks it. In a terminal, lines are wrapped to its width, and the
    file or command with which a line begins is bold, errors red and warnings yellow, unless the
    variable NO_COLOR is set. A line of progress is removed first.
    """

    def __init__(self, stream: TextIO | None):
        """Wrap `stream`; None, which Python gives for a closed one, takes everything."""
        self.stream = stream or open(os.devnull, "w", encoding="utf-8")
        self.columns = shutil.get_terminal_size().columns if self.stream.isatty() else 0
        is_plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb" or os.name == "nt"
        self.is_coloured = bool(self.columns) and not is_plain
        self.begun = ""  # what the last line has so far

    def write(self, text: str) -> int:
        if text.startswith("\r"):  # a line that renews itself is not laid out
            return self.stream.write("\r" + self._encodable(text.removeprefix("\r")))
        hide_progress()
        lines = self._encodable(text).split("\n")
        shown = [self._lay_out(lines[0], self.begun)]
        shown += [self._lay_out(line) for line in lines[1:]]
        self.begun = lines[-1] if len(lines) > 1 else self.begun + lines[-1]
        return self.stream.write("\n".join(shown))

    def _lay_out(self, line: str, begun: str = "") -> str:
        """A line, or its rest after what it has already, wrapped and coloured."""
        if self.columns:
            wrapped = wrap_line(begun + line, self.columns)
            if wrapped.startswith(begun):
                line = wrapped[len(begun) :]
        if not self.is_coloured:
            return line
        if not begun:
            pattern, colour = (ERROR, RED) if ERROR.match(line) else (SUBJECT, BOLD)
            line = pattern.sub(rf"{colour}\g<0>{PLAIN}", line)
        return line if line.startswith("|") else WARNING.sub(rf"{YELLOW}\g<0>{PLAIN}", line)

    def _encodable(self, text: str) -> str:
        """The text with everything visible that shows nothing or that the encoding lacks."""
        encoding = self.stream.encoding or "utf-8"
        return visible(text).encode(encoding, "backslashreplace").decode(encoding)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


def wrap_line(line: str, columns: int) -> str:
    """A line in lines of at most this many columns, the later ones indented; rows of tables as they
    are."""
    if len(line) <= columns or line.startswith("|"):
        return line
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    return textwrap.fill(line, columns, subsequent_indent=indent, break_on_hyphens=False)


@contextmanager
def visible_output() -> Iterator[None]:
    """Make standard output and standard error visible streams in the block."""
    before = sys.stdout, sys.stderr
    sys.stdout = VisibleStream(sys.stdout)  # type: ignore[assignment]
    sys.stderr = VisibleStream(sys.stderr)  # type: ignore[assignment]
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def note(text: str) -> None:
    """Print a message on standard error, which keeps standard output for results."""
    print(text, file=sys.stderr, flush=True)


def with_progress(items: Iterable[Item], count: int, name: str) -> Iterator[Item]:
    """Yield the items; `working` shows the time, with the number and the name of the items."""
    plural = "" if count == 1 else "s"
    with working(f"{count} {name}{plural}") as is_done:
        for number, item in enumerate(items):
            if number:
                is_done(number / count)
            yield item


@contextmanager
def working(on: str) -> Iterator[Callable[[float], None]]:
    """Show how long the block has been running, in a `ProgressLine`.

    Yields a function that takes the share of the work that is done by now; from then on the
    remaining time is shown too, unless the work takes longer than that share lets expect.
    """
    ended = threading.Event()
    line = ProgressLine()
    total = 0.0

    def is_done(share: float) -> None:
        nonlocal total
        total = line.seconds / share

    def show() -> None:
        while not ended.wait(0.1):
            seconds = line.seconds
            to_go = time_to_go(seconds, seconds / total) if total else ""
            line.show(f"{on}: {seconds:.0f} s{to_go}")

    thread = threading.Thread(target=show, daemon=True)
    thread.start()
    try:
        with line:
            yield is_done
    finally:
        ended.set()
        thread.join()
        hide_progress()
