"""What is printed while a training runs."""

import shutil
import sys
import time

from numpy_cae.training.state import HELD_OUT, TrainingState

INTERVAL_SECONDS = 30.0
"""INTERVAL_SECONDS: within an epoch, a line is printed when this time (s) has passed since the last
one; in a terminal, where one line renews itself, after a hundredth of it."""


class ProgressPrinter:
    """A `report` that prints a line after each epoch, and every `INTERVAL_SECONDS` within one.

    The lines go to standard error: "layer 1, epoch 3/25: loss 0.05120, 30 s elapsed, 220 s left".
    In a terminal a stage has one short line, which renews itself. An error on held-out takes is
    printed where the losses have one.

    Examples
    --------
    >>> printer = ProgressPrinter()  # train_autoencoder(model, windows, report=printer)
    """

    def __init__(self) -> None:
        self.printed = time.monotonic()
        self.columns = shutil.get_terminal_size().columns - 1 if sys.stderr.isatty() else 0

    def __call__(self, state: TrainingState) -> None:
        """Print a line if it is time."""
        interval = INTERVAL_SECONDS / 100 if self.columns else INTERVAL_SECONDS
        if state.step and time.monotonic() - self.printed <= interval:
            return
        epochs = state.epoch + state.step / state.steps
        losses = state.losses
        done = f"{epochs:.2f}/{state.epochs}" if state.step else f"{state.epoch}/{state.epochs}"
        done += "".join(f": loss {loss:.5f}" for loss in losses.get(state.name, [])[-1:])
        done += "".join(f", held-out {error:.2f} cm" for error in losses.get(HELD_OUT, [])[-1:])
        elapsed = state.seconds[state.name]
        left = elapsed * (state.epochs / epochs - 1)
        times = f"{left:.0f} s left"
        if not self.columns:  # one line of a terminal is short
            times = f"{elapsed:.0f} s elapsed, {times}"
        line = f"{state.name}, epoch {done}, {times}"
        if self.columns:
            is_last = state.epoch == state.epochs
            line = "\r" + line[: self.columns].ljust(self.columns) + "\n" * is_last
        print(line, end="" if self.columns else "\n", file=sys.stderr, flush=True)
        self.printed = time.monotonic()
