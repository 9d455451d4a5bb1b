"""The training loop of both networks: epochs of steps, with callbacks between them.

What follows from a point in training depends on the weights, the state of the optimiser and of the
random numbers, the order of this epoch's examples and the position in it, and on nothing else. A
checkpoint keeps exactly these, so an interrupted run ends in the same bits as an uninterrupted one.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from numpy_cae.training.adam import Adam
from numpy_cae.training.callback import Callback
from numpy_cae.training.checkpoint import Checkpoint, Position, State
from numpy_cae.training.sgd import Sgd


@dataclass
class Task:
    """One stage of training.

    Parameters
    ----------
    name : str
        Such as "layer 1".
    epochs : int
    count, batch : int
        Examples in an epoch; of them in a step.
    draw_order : () -> array of int
        The examples of an epoch in their order.
    rate : (epoch, step, steps) -> float
        The learning rate; epochs and the `steps` steps of each count from 0.
    step : (examples, rate) -> float
        Takes one step of descent on these examples and returns the loss before it.
    optimiser : Sgd or Adam
        What `step` uses.
    culprit : (examples) -> str
        Names the part of the network that is not finite, where the loss on these is not.
    """

    name: str
    epochs: int
    count: int
    batch: int
    draw_order: Callable[[], np.ndarray]
    rate: Callable[[int, int, int], float]
    step: Callable[[np.ndarray, float], float]
    optimiser: Sgd | Adam
    culprit: Callable[[np.ndarray], str]


class Loop:
    """Runs stages one after another, from the beginning or from where a checkpoint says.

    Parameters
    ----------
    parameters : dict of name to array
        Every weight of the model; changed in place.
    rng : numpy.random.Generator
        The one that the steps draw from.
    history : object
        Its attributes are what JSON can hold; a checkpoint keeps them.

    Attributes
    ----------
    at : Position
    task : Task
    steps : int
        Steps in an epoch of the task.
    examples : array of int
        The examples of the last step.
    loss, rate : float
        Of the last step.
    """

    def __init__(self, parameters: dict[str, np.ndarray], rng: np.random.Generator, history: Any):
        self.parameters, self.rng, self.history = parameters, rng, history
        self.at = Position()
        self.loss = self.rate = 0.0
        self._stages = 0
        self._saved: dict[str, np.ndarray] = {}

    def resume(self, checkpoint: Checkpoint, run: str) -> None:
        """Continue from the checkpoint if it holds a state of this run (`fingerprint`)."""
        state = checkpoint.begin(run)
        if state is None:
            return
        for name, array in self.parameters.items():
            array[...] = state.arrays[name]
        self.rng.bit_generator.state = state.rng
        vars(self.history).update(state.history)
        self.at, self._saved = state.position, state.arrays

    def state(self) -> State:
        """Everything that the rest of the training depends on, as it is now."""
        arrays = self.parameters | self.task.optimiser.state
        return State(arrays, self.rng.bit_generator.state, self.at, vars(self.history))

    def run(self, task: Task, callbacks: Sequence[Callback]) -> None:
        """Run the next stage, or what an interrupted run left of it."""
        stage, self._stages = self._stages, self._stages + 1
        if stage < self.at.stage:
            return
        if stage > self.at.stage:
            self.at = Position(stage)
        elif self._saved:
            for name, array in task.optimiser.state.items():
                array[...] = self._saved[name]
        self.task = task
        self.steps = -(-task.count // task.batch)
        started = time.perf_counter() - self.at.seconds
        try:
            for callback in callbacks:
                callback.begin(self)
            while self.at.epoch < task.epochs:
                self._epoch(callbacks, started)
        finally:
            for callback in callbacks:
                callback.end()

    def _epoch(self, callbacks: Sequence[Callback], started: float) -> None:
        """Every example once, or those that are left of an interrupted epoch."""
        at, task = self.at, self.task
        if at.step == 0:
            at.order = task.draw_order()
        for step in range(at.step, self.steps):
            self.examples = at.order[step * task.batch : (step + 1) * task.batch]
            self.rate = task.rate(at.epoch, step, self.steps)
            self.loss = task.step(self.examples, self.rate)
            at.total += self.loss * len(self.examples)
            at.step = step + 1
            at.seconds = time.perf_counter() - started
            for callback in callbacks:
                callback.after_step(self)
        self.at = Position(at.stage, at.epoch + 1, seconds=at.seconds)
        for callback in callbacks:
            callback.after_epoch(self, at.total / task.count)
