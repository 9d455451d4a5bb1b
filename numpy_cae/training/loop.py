"""The loop of epochs and batches, where a training stands in it, and what it has measured."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.models.sequential_autoencoder import Weights
from numpy_cae.training.optimisers import Adam, Sgd
from numpy_cae.training.schedule import SequenceSchedule, Stage, rate_at

HELD_OUT = "held-out error, cm"
"""HELD_OUT: the name in a history of the errors on takes that are not trained on, by epoch."""
ADVICE = "a lower rate (--rate) or, in Python, a bound on the norm (`Stage.norm`) may help"


class DivergedError(NumpyCaeError, ArithmeticError):
    """Training whose loss or weights are no longer finite."""


@dataclass
class History:
    """What a training measured.

    `losses` holds, for each stage by name, the mean loss of every epoch. `train_sequential` adds
    the two terms of the loss of every step, "reconstruction" and "discrepancy". `seconds` holds the
    duration of each stage.

    Examples
    --------
    >>> History({"fine tuning": [0.5, 0.25]}, {"fine tuning": 12.0}).losses["fine tuning"][-1]
    0.25
    """

    losses: dict[str, list[float]] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)


@dataclass
class TrainingState:
    """Everything that the rest of a training depends on, and its loop over epochs and batches.

    A `Checkpoint` saves and loads the state.

    A function `report` gets the state after every step. `epoch` and `step` count what is done, so
    `step` is 0 after the last step of an epoch, whose mean loss is then the last of
    `history.losses[name]`.

    Examples
    --------
    >>> state = TrainingState({"w": np.zeros(3)}, np.random.default_rng(0))
    >>> x, stage = np.ones((3, 8, 5)), Stage(epochs=1, batch=2)
    >>> for step, rate in state.steps_of("layer 1", stage, state.weights, len(x)):
    ...     batch = x[2 * step : 2 * step + 2]
    ...     state.end_step(1.0 if step == 0 else 4.0, batch, rate)
    >>> state.stage, state.history.losses
    (1, {'layer 1': [2.0]})
    """

    weights: Weights  # all weights of the model, which training changes in place
    rng: np.random.Generator
    history: History = field(default_factory=History)
    stage: int = 0  # stages done
    epoch: int = 0  # epochs of this stage done
    step: int = 0  # steps of this epoch done
    total: float = 0.0  # sum of the losses of this epoch's examples so far
    order: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))  # of the examples
    restored: dict[str, np.ndarray] = field(default_factory=dict)  # the optimiser's, from a file

    name: str = ""  # name of the stage, such as "layer 1"
    optimiser: Sgd | Adam = field(default_factory=lambda: Sgd({}))
    epochs: int = 0  # epochs of the stage
    steps: int = 0  # steps in an epoch
    examples: int = 0  # examples in an epoch
    loss: float = float("nan")  # loss of the last step
    save: Callable[["TrainingState"], None] = lambda state: None  # to the checkpoint, when due
    saved: Callable[[], str] = lambda: "there is no checkpoint"  # where the last good state is
    started: float = 0.0  # when the stage would have started without an interruption

    def steps_of(
        self, name: str, stage: Stage | SequenceSchedule, parameters: Weights, examples: int
    ) -> Iterator[tuple[int, float]]:
        """The loop over the epochs and the batches of a stage, of both networks.

        Begins the stage, or continues the one that a checkpoint has restored. Yields the number of
        each step in its epoch, of which each uses `stage.batch` of the `examples`, and the learning
        rate. The loop's body takes the step and calls `end_step`.
        """
        by_adam = stage.optimiser == "adam"
        self.optimiser = Adam(parameters) if by_adam else Sgd(parameters, stage.momentum)
        for part, array in self.optimiser.state.items():
            array[...] = self.restored.get(part, array)
        self.restored = {}
        self.name = name
        self.epochs = stage.epochs
        self.steps = -(-examples // stage.batch)
        self.examples = examples
        self.history.losses.setdefault(name, [])
        self.started = time.perf_counter() - self.history.seconds.setdefault(name, 0.0)
        for epoch in range(self.epoch, stage.epochs):
            for step in range(self.step, self.steps):
                yield step, rate_at(stage, epoch, step, self.steps)
                self.save(self)
        self.stage += 1
        self.epoch = 0

    def end_step(self, loss: float, x: np.ndarray, rate: float) -> None:
        """Count a step with the mean loss of the examples x, and the epoch if the step ends it.

        Raises DivergedError if the loss is not finite or, since a finite loss can precede infinite
        weights, if a weight is not finite at the end of an epoch.
        """
        self._require_finite(loss, x, rate)
        self.loss = loss
        self.total += loss * len(x)
        self.step += 1
        self.history.seconds[self.name] = time.perf_counter() - self.started
        if self.step == self.steps:
            self.history.losses[self.name].append(self.total / self.examples)
            self.epoch += 1
            self.step = 0
            self.total = 0.0

    def _require_finite(self, loss: float, x: np.ndarray, rate: float) -> None:
        """The message names the first array, from the input x on, that is not finite."""
        last = self.step + 1 == self.steps
        if np.isfinite(loss) and not (last and nonfinite(self.weights)):
            return
        parts = [*nonfinite({"the input": x} | self.weights), f"the output of {self.name}"]
        where = f"{self.name}, epoch {self.epoch + 1}, step {self.step + 1}"
        raise DivergedError(
            f"{where}: the loss is {loss:.4g} at rate {rate:.4g}; not finite: {parts[0]}; "
            f"{self.saved()}; {ADVICE}"
        )


def nonfinite(arrays: dict[str, np.ndarray]) -> list[str]:
    """The names of the arrays that hold a number that is not finite."""
    return [name for name, array in arrays.items() if not np.isfinite(array).all()]
