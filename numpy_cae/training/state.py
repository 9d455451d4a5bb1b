"""Where a training stands, and what it has measured."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

POSITION = ("stage", "epoch", "step", "total", "examples", "losses", "seconds")
"""The fields of a `TrainingState` from which, with the arrays, a training can be continued."""

HELD_OUT = "held-out error, cm"
"""The name in the losses of the errors on takes that are not trained on, by epoch."""


@dataclass
class TrainingState:
    """Where a training stands, and what it has measured.

    `losses` holds, for each stage by name, the mean loss of every epoch. `train_sequential` adds
    the two terms of the loss of every step, "reconstruction" and "discrepancy". `seconds` holds the
    duration of each stage.

    A function `report` gets the state after every step. `epoch` and `step` count what is done, so
    `step` is 0 after the last step of an epoch, whose mean loss is then the last of
    `losses[name]`.

    Examples
    --------
    Two steps of an epoch, with the losses and the numbers of their examples:

    >>> state = TrainingState()
    >>> state.begin_stage("layer 1", epochs=1, steps=2)
    >>> state.count_step(1.0, examples=2)
    >>> state.count_step(4.0, examples=1)
    >>> state.end_stage()
    >>> state.stage, state.losses
    (1, {'layer 1': [2.0]})
    """

    stage: int = 0  # stages done
    epoch: int = 0  # epochs of this stage done
    step: int = 0  # steps of this epoch done
    total: float = 0.0  # sum of the losses of this epoch's examples so far
    examples: int = 0  # their number
    losses: dict[str, list[float]] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    name: str = ""  # name of the stage, such as "layer 1"
    epochs: int = 0  # epochs of the stage
    steps: int = 0  # steps in an epoch
    loss: float = float("nan")  # loss of the last step
    started: float = 0.0  # when the stage would have started without an interruption

    def begin_stage(self, name: str, epochs: int, steps: int) -> None:
        """Begin a stage, or continue the one that was interrupted."""
        self.name = name
        self.epochs = epochs
        self.steps = steps
        self.losses.setdefault(name, [])
        self.started = time.perf_counter() - self.seconds.setdefault(name, 0.0)

    def count_step(self, loss: float, examples: int) -> None:
        """Count a step, with the mean loss of its examples, and the epoch if the step ends it."""
        self.loss = loss
        self.total += loss * examples
        self.examples += examples
        self.step += 1
        self.seconds[self.name] = time.perf_counter() - self.started
        if self.step == self.steps:
            self.losses[self.name].append(self.total / self.examples)
            self.epoch += 1
            self.step = 0
            self.total = 0.0
            self.examples = 0

    def end_stage(self) -> None:
        """Count the stage."""
        self.stage += 1
        self.epoch = 0
