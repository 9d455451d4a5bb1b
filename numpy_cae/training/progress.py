"""What is printed while a training runs."""

import sys
import time

from numpy_cae.progress import ProgressLine, hide_progress
from numpy_cae.training.state import HELD_OUT, TrainingState

INTERVAL_SECONDS = 30.0
"""Within an epoch, a line is printed when this time (s) has passed since the last one."""


class ProgressPrinter:
    """A `report` that shows a line, in a terminal one that vanishes when the stage is done.

    Elsewhere it prints a line after each epoch, and every `INTERVAL_SECONDS` within one. The lines
    go to standard error: "layer 1, epoch 3/25: loss 0.05120, 30 s elapsed, 220 s left". An error on
    held-out takes is shown where the losses have one.

    Examples
    --------
    >>> printer = ProgressPrinter()  # train_autoencoder(model, windows, report=printer)
    """

    def __init__(self) -> None:
        self.last_print = time.monotonic()
        self.line = ProgressLine()

    def __call__(self, state: TrainingState) -> None:
        """Show or print a line if it is time."""
        if self.line.is_terminal:
            if state.epoch == state.epochs:
                hide_progress()
            else:
                self.line.show(describe_progress(state, is_short=True))
            return
        if state.step and time.monotonic() - self.last_print <= INTERVAL_SECONDS:
            return
        print(describe_progress(state), file=sys.stderr, flush=True)
        self.last_print = time.monotonic()


def describe_progress(state: TrainingState, is_short: bool = False) -> str:
    """Epoch, last loss, last error on held-out takes, time elapsed (unless short) and time left."""
    epochs = state.epoch + state.step / state.steps
    number = f"{epochs:.2f}" if state.step else f"{state.epoch}"
    text = f"{state.name}, epoch {number}/{state.epochs}"
    if losses := state.losses.get(state.name):
        text += f": loss {losses[-1]:.5f}"
    if errors := state.losses.get(HELD_OUT):
        text += f", held-out {errors[-1]:.2f} cm"
    elapsed = state.seconds[state.name]
    if not is_short:
        text += f", {elapsed:.0f} s elapsed"
    return f"{text}, {elapsed * (state.epochs / epochs - 1):.0f} s left"
