"""What is printed while a training runs."""

import shutil
import sys
import time

from numpy_cae.training.state import HELD_OUT, TrainingState

INTERVAL_SECONDS = 30.0
"""Within an epoch, a line is printed when this time (s) has passed since the last one; in a
terminal, where one line renews itself, after a hundredth of it."""


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
        self.last_print = time.monotonic()
        self.columns = 0  # of the terminal, if there is one
        if sys.stderr.isatty():
            self.columns = shutil.get_terminal_size().columns - 1

    def __call__(self, state: TrainingState) -> None:
        """Print a line if it is time."""
        interval = INTERVAL_SECONDS / 100 if self.columns else INTERVAL_SECONDS
        if state.step and time.monotonic() - self.last_print <= interval:
            return
        if self.columns:
            line = describe_progress(state, is_short=True)
            end = "\n" if state.epoch == state.epochs else ""
            print(
                "\r" + line[: self.columns].ljust(self.columns),
                end=end,
                file=sys.stderr,
                flush=True,
            )
        else:
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
