"""How far training has come: a bar where tqdm is installed, a line an epoch where it is not."""

from __future__ import annotations

import sys
import time

try:
    from tqdm import tqdm
except ImportError:  # the extra `progress` is optional
    tqdm = None


class Progress:
    """Follows one stage of training on standard error.

    Parameters
    ----------
    stage : str
        What is being trained, such as "layer 1 of 3".
    epochs, steps : int
        Epochs of the stage, steps of descent in an epoch.
    shown : bool
        False keeps silent.
    bar : bool
        False prints lines even where tqdm is installed.
    """

    def __init__(self, stage: str, epochs: int, steps: int, shown: bool = True, bar: bool = True):
        self.stage, self.epochs, self.shown = stage, epochs, shown
        self.started = time.monotonic()
        self.before = 0.0
        self.bar = None
        if shown and bar and tqdm is not None and epochs:
            self.bar = tqdm(total=epochs * steps, desc=stage, unit=" steps", file=sys.stderr)
        self.steps = steps

    def begin_at(self, done: int) -> None:
        """So many steps were done before an interruption."""
        self.before = done / self.steps
        if self.bar is not None:
            self.bar.initial = done
            self.bar.reset(self.bar.total)

    def step(self) -> None:
        """One step of descent was made."""
        if self.bar is not None:
            self.bar.update()

    def epoch(self, epoch: int, loss: float) -> None:
        """An epoch ended with this mean loss; epochs count from 0."""
        if self.bar is not None:
            self.bar.set_postfix_str(f"epoch {epoch + 1}/{self.epochs}, loss {loss:.5f}")
        elif self.shown:
            seconds = time.monotonic() - self.started
            left = seconds / (epoch + 1 - self.before) * (self.epochs - epoch - 1)
            print(
                f"{self.stage}, epoch {epoch + 1}/{self.epochs}: loss {loss:.5f}, "
                f"{seconds:.0f} s gone, {left:.0f} s to go",
                file=sys.stderr,
                flush=True,
            )

    def close(self) -> None:
        """The stage has ended."""
        if self.bar is not None:
            self.bar.close()
