"""What is said of a training while it runs: lines of progress, and an error if it diverges."""

import sys
import time

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.training.checkpoint import Checkpoint
from numpy_cae.training.state import TrainingState

INTERVAL = 30.0
ADVICE = "a lower rate (--rate) or, in Python, a bound on the norm (`Stage.norm`) may help"


class ProgressPrinter:
    """A `report` that prints a line after each epoch, and every `INTERVAL` seconds within one.

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
        if state.step and time.monotonic() - self.printed <= INTERVAL:
            return
        done, loss = f"{state.epoch + state.step / state.steps:.2f}", ""
        if state.step == 0:
            done, loss = f"{state.epoch}", f": loss {state.history.losses[state.name][-1]:.5f}"
        elapsed = state.history.seconds[state.name]
        left = elapsed * (state.epochs / (state.epoch + state.step / state.steps) - 1)
        times = f"{elapsed:.0f} s elapsed, {left:.0f} s left"
        line = f"{self.training}{state.name}, epoch {done}/{state.epochs}{loss}, {times}"
        print(line, file=sys.stderr, flush=True)
        self.printed = time.monotonic()


class DivergedError(NumpyCaeError, ArithmeticError):
    """Training whose loss or weights are no longer finite."""


def require_finite(
    loss: float, x: np.ndarray, rate: float, state: TrainingState, checkpoint: Checkpoint | None
) -> None:
    """Raise DivergedError if the loss of the step that was made is not finite or, since a finite
    loss can precede infinite weights, if a weight is not finite at the end of an epoch.

    The message names the first array, from the input x on, that is not finite.
    """
    last = state.step + 1 == state.steps
    if np.isfinite(loss) and not (last and nonfinite(state.weights)):
        return
    parts = [*nonfinite({"the input": x} | state.weights), f"the output of {state.name}"]
    status = checkpoint.status() if checkpoint else "there is no checkpoint"
    raise DivergedError(
        f"{state.name}, epoch {state.epoch + 1}, step {state.step + 1}: the loss is {loss:.4g} at "
        f"rate {rate:.4g}; not finite: {parts[0]}; {status}; {ADVICE}"
    )


def nonfinite(arrays: dict[str, np.ndarray]) -> list[str]:
    """The names of the arrays that hold a number that is not finite."""
    return [name for name, array in arrays.items() if not np.isfinite(array).all()]
