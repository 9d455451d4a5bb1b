"""The lines that are printed while a training runs."""

import sys
import time

from numpy_cae.training.state import TrainingState

INTERVAL_SECONDS = 30.0
"""Within an epoch, a line is printed when this many seconds have passed since the last one."""


class ProgressPrinter:
    """A `report` that prints a line after each epoch, and every `INTERVAL_SECONDS` within one.

    The lines go to standard error: "layer 1, epoch 3/25: loss 0.05120, 30 s elapsed, 220 s left".
    `training` is the name of the training, with which each line begins, where there are several.

    Examples
    --------
    >>> printer = ProgressPrinter()  # train_autoencoder(model, windows, report=printer)
    """

    def __init__(self, training: str = "") -> None:
        self.training = training and f"{training}: "
        self.printed = time.monotonic()

    def __call__(self, state: TrainingState) -> None:
        """Print a line if it is time."""
        if state.step and time.monotonic() - self.printed <= INTERVAL_SECONDS:
            return
        epochs = state.epoch + state.step / state.steps
        if state.step == 0:
            loss = state.history.losses[state.name][-1]
            done = f"{state.epoch}/{state.epochs}: loss {loss:.5f}"
        else:
            done = f"{epochs:.2f}/{state.epochs}"
        elapsed = state.history.seconds[state.name]
        left = elapsed * (state.epochs / epochs - 1)
        times = f"{elapsed:.0f} s elapsed, {left:.0f} s left"
        line = f"{self.training}{state.name}, epoch {done}, {times}"
        print(line, file=sys.stderr, flush=True)
        self.printed = time.monotonic()
