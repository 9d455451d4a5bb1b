"""Where a training stands, and what it has measured."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from numpy_cae.errors import NumpyCaeError
from numpy_cae.training.adam import Adam
from numpy_cae.training.sgd import Sgd

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
    """Everything that the rest of a training depends on; a `Checkpoint` saves and loads it.

    A function `report` gets the state after every step. `epoch` and `step` count what is done, so
    `step` is 0 after the last step of an epoch, whose mean loss is then the last of
    `history.losses[name]`.

    Examples
    --------
    >>> state = TrainingState({"w": np.zeros(3)}, np.random.default_rng(0))
    >>> state.begin_stage("layer 1", Sgd(state.weights), epochs=2, steps=2, examples=3)
    >>> state.end_step(loss=1.0, examples=2)
    >>> state.end_step(loss=4.0, examples=1)
    >>> state.epoch, state.step, state.history.losses
    (1, 0, {'layer 1': [2.0]})
    """

    weights: dict[str, np.ndarray]  # all weights of the model, which training changes in place
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
    saved: Callable[[], str] = lambda: "there is no checkpoint"  # where the last good state is
    started: float = 0.0  # when the stage would have started without an interruption

    def begin_stage(
        self, name: str, optimiser: Sgd | Adam, epochs: int, steps: int, examples: int
    ) -> None:
        """Begin a stage, or continue the one that a checkpoint has restored."""
        for part, array in optimiser.state.items():
            array[...] = self.restored.get(part, array)
        self.restored = {}
        self.name = name
        self.optimiser = optimiser
        self.epochs = epochs
        self.steps = steps
        self.examples = examples
        self.history.losses.setdefault(name, [])
        self.started = time.perf_counter() - self.history.seconds.setdefault(name, 0.0)

    def end_step(self, loss: float, examples: int) -> None:
        """Count a step with the mean loss of its examples, and the epoch if the step ends it."""
        self.loss = loss
        self.total += loss * examples
        self.step += 1
        self.history.seconds[self.name] = time.perf_counter() - self.started
        if self.step == self.steps:
            self.history.losses[self.name].append(self.total / self.examples)
            self.epoch += 1
            self.step = 0
            self.total = 0.0

    def end_stage(self) -> None:
        """Count a stage."""
        self.stage += 1
        self.epoch = 0

    def require_finite(self, loss: float, x: np.ndarray, rate: float) -> None:
        """Raise DivergedError if the loss of the step that was made is not finite or, since a
        finite loss can precede infinite weights, if a weight is not finite at the end of an epoch.

        The message names the first array, from the input x on, that is not finite.
        """
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
