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
    culprit: Callable[[np.ndarray], str]  # what is not finite where the loss of examples is not
    optimiser: Sgd | Adam  # used by `step`


@dataclass
class Position:
    """How many stages, epochs of this stage and steps of this epoch are done; the sum of the
    epoch's losses, the time spent on the stage and the order of the epoch's examples."""

    stage: int = 0
    epoch: int = 0
    step: int = 0
    total: float = 0.0
    seconds: float = 0.0
    order: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))


class Callback:
    """Called between steps; each method does nothing unless it is overridden."""

    def after_step(self, loop: Loop) -> None:
        """A step was made; `loop.loss`, `loop.rate` and `loop.examples` are its own."""

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """An epoch ended with this mean loss; `loop.at.epoch` epochs are done."""


class Loop:
    """Runs stages one after another. `parameters` are all weights of the model by name, `rng` is
    what the steps draw from, and the attributes of `history` are of types that JSON knows."""

    def __init__(
        self,
        parameters: dict[str, np.ndarray],
        rng: np.random.Generator,
        history: Any,
        callbacks: list[Callback],
    ):
        self.parameters, self.rng, self.history = parameters, rng, history
        self.callbacks, self.at, self._stages = callbacks, Position(), 0
        self._resumed: dict[str, np.ndarray] = {}

    def resume(self, position: Position, arrays: dict, rng: dict, history: dict) -> None:
        """Continue from here; `rng` is a state of the generator. Call it before `run`."""
        for name, array in self.parameters.items():
            array[...] = arrays[name]
        self.rng.bit_generator.state = rng
        vars(self.history).update(history)
        self.at, self._resumed = position, arrays

    def run(self, task: Task) -> None:
        """Run the next stage, or what an interrupted run left of it."""
        stage, self._stages = self._stages, self._stages + 1
        if stage < self.at.stage:
            return
        if stage > self.at.stage:
            self.at = Position(stage)
        elif self._resumed:
            for name, array in task.optimiser.state.items():
                array[...] = self._resumed[name]
        self.task, self.steps = task, -(-task.count // task.stage.batch)
        started = time.perf_counter() - self.at.seconds
        while self.at.epoch < task.stage.epochs:
            self._epoch(started)

    def _epoch(self, started: float) -> None:
        """Use every example once, or those that are left of an interrupted epoch."""
        at, task, batch = self.at, self.task, self.task.stage.batch
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
        self.at = Position(at.stage, at.epoch + 1, seconds=at.seconds)
        for callback in self.callbacks:
            callback.after_epoch(self, at.total / task.count)
