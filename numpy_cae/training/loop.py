"""The training loop of both networks: epochs of steps, with callbacks between them.

What follows from a point in training depends on the weights, the states of the optimiser and of the
random numbers, the order of the epoch's examples and the position in it. A `Checkpoint` keeps
exactly these, so a run that continues from one ends in the same bits.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from numpy_cae.training.adam import Adam
from numpy_cae.training.schedule import SequenceSchedule, Stage, rate_at
from numpy_cae.training.sgd import Sgd


@dataclass
class Task:
    """One stage of training, such as layer 1."""

    name: str
    stage: Stage | SequenceSchedule
    count: int  # examples in an epoch
    shuffled: bool  # whether each epoch draws a new order of them
    step: Callable[[np.ndarray, float], float]  # examples and rate to the loss before one step
    nonfinite_part: Callable[[np.ndarray], str]  # names what holds NaN or infinity if the loss does
    optimiser: Sgd | Adam  # used by `step`


@dataclass
class Position:
    """How much of the training is done."""

    stage: int = 0  # stages done
    epoch: int = 0  # epochs of this stage done
    step: int = 0  # steps of this epoch done
    total: float = 0.0  # sum of the losses of this epoch's examples so far
    seconds: float = 0.0  # time spent on this stage
    order: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))  # of examples


class Callback:
    """Called between steps; each method does nothing unless it is overridden."""

    def after_step(self, loop: Loop) -> None:
        """A step was made; `loop.loss`, `loop.rate` and `loop.examples` are its own."""

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """An epoch ended with this mean loss; `loop.position.epoch` epochs are done."""


class Loop:
    """Runs stages one after another. `parameters` are all weights of the model by name, `rng` is
    what the steps draw from, and the attributes of `history` can be stored as JSON."""

    def __init__(
        self,
        parameters: dict[str, np.ndarray],
        rng: np.random.Generator,
        history: Any,
        callbacks: list[Callback],
    ):
        self.parameters, self.rng, self.history = parameters, rng, history
        self.callbacks, self.position, self._stages = callbacks, Position(), 0
        self._resumed: dict[str, np.ndarray] = {}

    def resume(self, position: Position, arrays: dict, rng: dict, history: dict) -> None:
        """Continue from here; `rng` is a state of the generator. Call it before `run`.

        ValueError if a weight, the order of the examples or the history is not one of this loop.
        """
        at = position
        counts = at.stage, at.epoch, at.step
        whole = all(isinstance(count, int) and count >= 0 for count in counts)
        if not whole or not np.isfinite([at.total, at.seconds]).all():
            raise ValueError("the position is not one of a training")
        if at.order.dtype.kind != "i" or not np.array_equal(
            np.sort(at.order), np.arange(at.order.size)
        ):
            raise ValueError("the order of the examples is not one of a training")
        if set(history) != set(vars(self.history)):
            raise ValueError("the history is of another training")
        for name, array in self.parameters.items():
            _restore(array, arrays, name)
        self.rng.bit_generator.state = rng
        vars(self.history).update(history)
        self.position, self._resumed = position, arrays

    def run(self, task: Task) -> None:
        """Run the next stage, or what an interrupted run left of it."""
        stage, self._stages = self._stages, self._stages + 1
        if stage < self.position.stage:
            return
        if stage > self.position.stage:
            self.position = Position(stage)
        elif self._resumed:
            for name, array in task.optimiser.state.items():
                _restore(array, self._resumed, name)
            if self.position.step and self.position.order.size != task.count:
                raise ValueError("the order of the examples is of another training")
        self.task, self.steps = task, -(-task.count // task.stage.batch)
        started = time.perf_counter() - self.position.seconds
        while self.position.epoch < task.stage.epochs:
            self._epoch(started)

    def _epoch(self, started: float) -> None:
        """Use every example once, or those that are left of an interrupted epoch."""
        at, task, batch = self.position, self.task, self.task.stage.batch
        if at.step == 0:
            at.order = self.rng.permutation(task.count) if task.shuffled else np.arange(task.count)
        for step in range(at.step, self.steps):
            self.examples = at.order[step * batch : (step + 1) * batch]
            self.rate = rate_at(task.stage, at.epoch, step, self.steps)
            self.loss = task.step(self.examples, self.rate)
            at.total += self.loss * len(self.examples)
            at.step = step + 1
            at.seconds = time.perf_counter() - started
            for callback in self.callbacks:
                callback.after_step(self)
        self.position = Position(at.stage, at.epoch + 1, seconds=at.seconds)
        for callback in self.callbacks:
            callback.after_epoch(self, at.total / task.count)


def _restore(array: np.ndarray, arrays: dict[str, np.ndarray], name: str) -> None:
    """Copy the array of that name, which must have the same shape and dtype and be finite."""
    found = arrays.get(name)
    if found is None or (found.shape, found.dtype) != (array.shape, array.dtype):
        raise ValueError(f"has no {name} of shape {array.shape} and {array.dtype}")
    if not np.isfinite(found).all():
        raise ValueError(f"{name} holds values that are not finite numbers")
    array[...] = found
