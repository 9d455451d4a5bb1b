"""Training whose loss or weights are no longer finite: where it happened, and what to try."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.training.callback import Callback
from numpy_cae.training.checkpoint import Checkpoint

if TYPE_CHECKING:
    from numpy_cae.training.loop import Loop


class DivergedError(NumpyCaeError, ArithmeticError):
    """Training whose loss or weights are no longer finite.

    Parameters
    ----------
    where : str
        Stage, epoch and examples, such as "layer 1, epoch 2, window 17".
    problem : str
        What is wrong and at which rate.
    culprit : str
        The part of the network that is no longer finite.
    status : str
        Where the last good state is.
    advice : str
        What may keep it finite.
    """

    def __init__(self, where: str, problem: str, culprit: str, status: str, advice: str):
        self.where, self.problem, self.culprit = where, problem, culprit
        self.status, self.advice = status, advice
        super().__init__(f"{where}: {problem}, first in {culprit}; {status}; {advice}")


class DivergenceCheck(Callback):
    """Raises DivergedError after a step whose loss, or an epoch whose weights, are not finite.

    Parameters
    ----------
    example : str
        What an example is called, such as "window".
    advice : str
    checkpoint : Checkpoint or None
        The one that keeps the last good state.
    """

    def __init__(self, example: str, advice: str, checkpoint: Checkpoint | None):
        self.example, self.advice, self.checkpoint = example, advice, checkpoint

    def after_step(self, loop: Loop) -> None:
        """Check the loss."""
        if np.isfinite(loop.loss):
            return
        numbers = format_numbers(self.example, loop.examples)
        raise self._error(
            f"{loop.task.name}, epoch {loop.at.epoch + 1}, {numbers}",
            f"the loss is {loop.loss} at rate {loop.rate:.4g}",
            loop.task.culprit(loop.examples),
        )

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Check the weights: the loss before a step can be finite and the weights after it not."""
        self.require_finite_weights(loop, loop.at.epoch)

    def require_finite_weights(self, loop: Loop, epoch: int) -> None:
        """Raise DivergedError, naming this epoch, where a weight is not finite."""
        names = nonfinite(loop.parameters)
        if names:
            raise self._error(
                f"{loop.task.name}, epoch {epoch}",
                f"weights are no longer finite at rate {loop.rate:.4g}",
                f"the weights {names[0]}",
            )

    def _error(self, where: str, problem: str, culprit: str) -> DivergedError:
        status = "there is no checkpoint"
        if self.checkpoint is not None:
            status = self.checkpoint.status()
        return DivergedError(where, problem, culprit, status, self.advice)


class SaveState(Callback):
    """Saves the state after every epoch, and within one as often as the checkpoint says.

    A state whose weights are not finite is never saved.
    """

    def __init__(self, checkpoint: Checkpoint, check: DivergenceCheck):
        self.checkpoint, self.check = checkpoint, check

    def after_step(self, loop: Loop) -> None:
        """Save the state if that is due."""
        if loop.at.step < loop.steps and self.checkpoint.is_due():
            self.check.require_finite_weights(loop, loop.at.epoch + 1)
            self.checkpoint.save(loop.state())

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Save the state; `DivergenceCheck` has checked the weights."""
        self.checkpoint.save(loop.state())


def nonfinite(weights: Mapping[str, np.ndarray]) -> list[str]:
    """The names of the arrays that hold a number that is not finite."""
    return [name for name, array in weights.items() if not np.isfinite(array).all()]


def format_numbers(noun: str, numbers: np.ndarray) -> str:
    """Such as "window 5" or "windows 1, 2, …" for a message; counted from 1, at most eight."""
    listed = ", ".join(str(number + 1) for number in list(numbers)[:8])
    return f"{noun}{'s' * (len(numbers) > 1)} {listed}{', …' if len(numbers) > 8 else ''}"
