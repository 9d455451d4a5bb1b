"""What is reported between steps: progress on standard error, and divergence as an error."""

import sys
import time

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.training.checkpoint import Checkpoint
from numpy_cae.training.loop import Callback, Loop

INTERVAL = 30.0


class Progress(Callback):
    """Prints lines such as "layer 1, epoch 3/25: loss 0.05120, 30 s elapsed, 220 s left", after
    each epoch and every `INTERVAL` seconds within one."""

    def __init__(self) -> None:
        self.printed = time.monotonic()

    def after_step(self, loop: Loop) -> None:
        """Print a line if the last one is older than `INTERVAL` seconds."""
        if time.monotonic() - self.printed > INTERVAL and loop.position.step < loop.steps:
            self._print(loop, loop.position.epoch + loop.position.step / loop.steps, "")

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Print a line with the mean loss."""
        self._print(loop, loop.position.epoch, f": loss {loss:.5f}")

    def _print(self, loop: Loop, done: float, loss: str) -> None:
        elapsed, epochs = loop.position.seconds, loop.task.stage.epochs
        left = elapsed / done * (epochs - done)
        epoch = f"{done:.2f}" if done % 1 else f"{done:.0f}"
        times = f"{elapsed:.0f} s elapsed, {left:.0f} s left"
        line = f"{loop.task.name}, epoch {epoch}/{epochs}{loss}, {times}"
        print(line, file=sys.stderr, flush=True)
        self.printed = time.monotonic()


class DivergedError(NumpyCaeError, ArithmeticError):
    """Training whose loss or weights are no longer finite."""


class DivergenceCheck(Callback):
    """Raises DivergedError after a step whose loss, or an epoch whose weights, are not finite.

    The message names the stage, the epoch, the step, the rate, the part of the network, the last
    good state in `checkpoint` and what may help, `advice`.
    """

    def __init__(self, advice: str, checkpoint: Checkpoint | None):
        self.advice, self.checkpoint = advice, checkpoint

    def after_step(self, loop: Loop) -> None:
        """Check the loss."""
        if not np.isfinite(loop.loss):
            where = f"epoch {loop.position.epoch + 1}, step {loop.position.step}"
            part = loop.task.nonfinite_part(loop.examples)
            self._raise(loop, where, f"the loss is {loop.loss}", part)

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Check the weights: the loss before a step can be finite and the weights after it not."""
        if names := nonfinite(loop.parameters):
            where = f"epoch {loop.position.epoch}"
            self._raise(loop, where, "weights are no longer finite", f"the weights {names[0]}")

    def _raise(self, loop: Loop, where: str, problem: str, part: str) -> None:
        status = self.checkpoint.status() if self.checkpoint else "there is no checkpoint"
        raise DivergedError(
            f"{loop.task.name}, {where}: {problem} at rate {loop.rate:.4g}, first in {part}; "
            f"{status}; {self.advice}"
        )


def nonfinite(weights: dict[str, np.ndarray]) -> list[str]:
    """The names of the arrays that hold a number that is not finite."""
    return [name for name, array in weights.items() if not np.isfinite(array).all()]
