"""Training whose loss or weights are no longer finite: where it happened, and what to try."""

from __future__ import annotations

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.training.checkpoint import Checkpoint
from numpy_cae.training.loop import Callback, Loop


class DivergedError(NumpyCaeError, ArithmeticError):
    """Training whose loss or weights are no longer finite."""


class DivergenceCheck(Callback):
    """Raises DivergedError after a step whose loss, or an epoch whose weights, are not finite.

    The message names the stage, the epoch, the step, the rate, the part of the network, the last
    good state in `checkpoint` and what may help, `advice`.
    """

    def __init__(self, advice: str, checkpoint: Checkpoint | None):
        self.advice = advice
        self.checkpoint = checkpoint

    def after_step(self, loop: Loop) -> None:
        """Check the loss."""
        if not np.isfinite(loop.loss):
            where = f"epoch {loop.at.epoch + 1}, step {loop.at.step}"
            self._raise(loop, where, f"the loss is {loop.loss}", loop.task.culprit(loop.examples))

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Check the weights: the loss before a step can be finite and the weights after it not."""
        names = nonfinite(loop.parameters)
        if names:
            where = f"epoch {loop.at.epoch}"
            self._raise(loop, where, "weights are no longer finite", f"the weights {names[0]}")

    def _raise(self, loop: Loop, where: str, problem: str, culprit: str) -> None:
        status = "there is no checkpoint"
        if self.checkpoint is not None:
            status = self.checkpoint.status()
        raise DivergedError(
            f"{loop.task.name}, {where}: {problem} at rate {loop.rate:.4g}, first in {culprit}; "
            f"{status}; {self.advice}"
        )


def nonfinite(weights: dict[str, np.ndarray]) -> list[str]:
    """The names of the arrays that hold a number that is not finite."""
    return [name for name, array in weights.items() if not np.isfinite(array).all()]
