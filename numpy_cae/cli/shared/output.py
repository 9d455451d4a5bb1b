"""Output of the commands: messages on standard error, made visible and laid out."""

import os
import re
import shutil
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO, TypeVar

from numpy_cae.visible import visible

Item = TypeVar("Item")


BOLD = "\x1b[1m"
PLAIN = "\x1b[0m"
"""What a terminal takes to print bold, and to end that."""


class VisibleStream:
    """A text stream whose writing makes every character visible, whatever names are printed: as an
    escape if the stream's encoding lacks it. In a terminal, lines are wrapped to its width, and the
    file or command with which a line begins is bold, unless the variable NO_COLOR is set.
    """

    def __init__(self, stream: TextIO | None):
        """Wrap `stream`; None, which Python gives for a closed one, takes everything."""
        self.stream = stream or open(os.devnull, "w", encoding="utf-8")
        self.columns = shutil.get_terminal_size().columns if self.stream.isatty() else 0
        is_plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb" or os.name == "nt"
        self.is_bold = bool(self.columns) and not is_plain

    def write(self, text: str) -> int:
        if text.startswith("\r"):  # a line that renews itself is not laid out
            return self.stream.write("\r" + self._encodable(text.removeprefix("\r")))
        shown = self._encodable(text)
        if self.columns:
            shown = "\n".join(wrap_line(line, self.columns) for line in shown.split("\n"))
        if self.is_bold:
            shown = re.sub(r"(?m)^([^\s|][^|\n]*?:)(?=\s)", rf"{BOLD}\1{PLAIN}", shown)
        return self.stream.write(shown)

    def _encodable(self, text: str) -> str:
        """The text with everything visible that shows nothing or that the encoding lacks."""
        encoding = self.stream.encoding or "utf-8"
        return visible(text).encode(encoding, "backslashreplace").decode(encoding)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


def wrap_line(line: str, columns: int) -> str:
    """A line in lines of at most so many columns, the later ones indented; rows of tables as they
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
    """Yield the items; `working` prints the time, with the number and the name of the items."""
    plural = "" if count == 1 else "s"
    with working(f"{count} {name}{plural}") as is_done:
        for number, item in enumerate(items):
            if number:
                is_done(number / count)
            yield item


@contextmanager
def working(on: str) -> Iterator[Callable[[float], None]]:
    """Print how long the block has been running: after 2 s, then at intervals that double.

    Yields a function that takes the share of the work that is done by now; from then on the
    remaining time is printed too, unless the work takes longer than that share lets expect.
    """
    begun = time.monotonic()
    ended = threading.Event()
    total = 0.0

    def is_done(share: float) -> None:
        nonlocal total
        total = (time.monotonic() - begun) / share

    def report() -> None:
        wait = 2.0
        while not ended.wait(wait):
            passed = time.monotonic() - begun
            message = f"{on}: {passed:.0f} s"
            if total > passed:
                message += f", about {total - passed:.0f} s to go at this speed"
            note(message)
            wait = min(2 * wait, 60.0)

    thread = threading.Thread(target=report, daemon=True)
    thread.start()
    try:
        yield is_done
    finally:
        ended.set()
        thread.join()
