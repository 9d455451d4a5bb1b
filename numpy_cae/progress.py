"""How far work is, in one line on standard error that vanishes when the work is done."""

import shutil
import sys
import time
from types import TracebackType
from typing import Self

FIRST_SECONDS = 2.0
"""Work that takes less time (s) shows nothing."""
RENEWAL_SECONDS = 0.3
"""In a terminal the line is renewed after this time (s)."""
LONGEST_SECONDS = 60.0
"""Elsewhere, as in a log, a line is printed after `FIRST_SECONDS`, then at intervals that double
up to this time (s)."""
_shown: list["ProgressLine"] = []
"""The line that is on the terminal, if any."""


class ProgressLine:
    """A line that says how far work is; use it in a `with` block.

    In a terminal the line renews itself, is removed before anything else is printed by a command,
    and at the end of the block. Elsewhere each line stays, and few are printed.

    Examples
    --------
    >>> with ProgressLine() as line:
    ...     for number in range(3):
    ...         line.show(f"{number} of 3 takes")
    """

    def __init__(self) -> None:
        self.begun = time.monotonic()
        self.interval = FIRST_SECONDS
        self.due = self.begun + FIRST_SECONDS
        self.is_terminal = sys.stderr.isatty()

    @property
    def seconds(self) -> float:
        """The time since the work began (s)."""
        return time.monotonic() - self.begun

    def show(self, text: str) -> None:
        """Show the text if it is time to."""
        now = time.monotonic()
        if now < self.due:
            return
        if self.is_terminal:
            self.due = now + RENEWAL_SECONDS
            hide_progress()
            columns = shutil.get_terminal_size().columns - 1
            sys.stderr.write("\r" + text[:columns])
            _shown.append(self)
        else:
            self.due = now + self.interval
            self.interval = min(2 * self.interval, LONGEST_SECONDS)
            sys.stderr.write(f"{text}\n")
        sys.stderr.flush()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self in _shown:
            hide_progress()


def hide_progress() -> None:
    """Remove the line that is on the terminal, if any; it comes back when it is next shown."""
    if _shown:
        _shown.clear()
        columns = shutil.get_terminal_size().columns - 1
        sys.stderr.write("\r" + " " * columns)
        sys.stderr.write("\r")
        sys.stderr.flush()


def time_to_go(seconds: float, share: float) -> str:
    """The time that work is going to take after so many seconds, in words, such as
    ", about 40 s to go"; "" where too little time has passed to tell.

    Examples
    --------
    >>> time_to_go(30.0, 0.25), time_to_go(0.1, 0.25)
    (', about 90 s to go', '')
    """
    if not 0 < share < 1 or seconds < FIRST_SECONDS:
        return ""
    return f", about {seconds * (1 / share - 1):.0f} s to go"
