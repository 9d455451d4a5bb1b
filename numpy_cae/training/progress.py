"""Progress on standard error: a line after each epoch, and every half minute within one."""

from __future__ import annotations

import sys
import time

from numpy_cae.training.loop import Callback, Loop

INTERVAL = 30.0


class Progress(Callback):
    """Prints lines such as "layer 1, epoch 3/25: loss 0.05120, 30 s elapsed, 220 s left"."""

    def __init__(self) -> None:
        self.printed = time.monotonic()

    def after_step(self, loop: Loop) -> None:
        """Print a line if the last one is older than `INTERVAL` seconds."""
        if time.monotonic() - self.printed > INTERVAL and loop.at.step < loop.steps:
            self._print(loop, loop.at.epoch + loop.at.step / loop.steps, "")

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Print a line with the mean loss."""
        self._print(loop, loop.at.epoch, f": loss {loss:.5f}")

    def _print(self, loop: Loop, done: float, loss: str) -> None:
        elapsed, epochs = loop.at.seconds, loop.task.stage.epochs
        left = elapsed / done * (epochs - done)
        epoch = f"{done:.2f}" if done % 1 else f"{done:.0f}"
        print(
            f"{loop.task.name}, epoch {epoch}/{epochs}{loss}, {elapsed:.0f} s elapsed, "
            f"{left:.0f} s left",
            file=sys.stderr,
            flush=True,
        )
        self.printed = time.monotonic()
