"""Progress on standard error: a bar where tqdm is installed, else a line for each epoch."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any

from numpy_cae.training.callback import Callback

try:
    from tqdm import tqdm
except ImportError:  # the extra `progress` is optional
    tqdm = None

if TYPE_CHECKING:
    from numpy_cae.training.loop import Loop


class Progress(Callback):
    """Shows the progress of each stage.

    Parameters
    ----------
    show : bool
        False prints nothing.
    bar : bool
        False prints lines even where tqdm is installed.
    """

    def __init__(self, show: bool = True, bar: bool = True):
        self.show, self.with_bar = show, bar
        self.bar: Any = None

    def begin(self, loop: Loop) -> None:
        """Start the clock; open a bar, at the steps that were done before an interruption."""
        done, task = loop.at.epoch * loop.steps + loop.at.step, loop.task
        self.started, self.epochs_before = time.monotonic(), done / loop.steps
        if self.show and self.with_bar and tqdm is not None and task.epochs:
            total = task.epochs * loop.steps
            self.bar = tqdm(
                total=total, initial=done, desc=task.name, unit=" steps", file=sys.stderr
            )

    def after_step(self, loop: Loop) -> None:
        """Move the bar."""
        if self.bar is not None:
            self.bar.update()

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Show the mean loss."""
        done, epochs = loop.at.epoch, loop.task.epochs
        if self.bar is not None:
            self.bar.set_postfix_str(f"epoch {done}/{epochs}, loss {loss:.5f}")
        elif self.show:
            seconds = time.monotonic() - self.started
            left = seconds / (done - self.epochs_before) * (epochs - done)
            print(
                f"{loop.task.name}, epoch {done}/{epochs}: loss {loss:.5f}, "
                f"{seconds:.0f} s elapsed, {left:.0f} s left",
                file=sys.stderr,
                flush=True,
            )

    def end(self) -> None:
        """Close the bar."""
        if self.bar is not None:
            self.bar.close()
            self.bar = None
