"""The loop of epochs and batches, where a training stands in it, and what it has measured; and the
file of this state, from which an interrupted run continues.

The state is everything that the rest of the training depends on: weights, optimiser, random
numbers, the order of the epoch's examples and the position in it. A resumed run is therefore
bit-identical to one that was not interrupted.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from numpy_cae.array_file import ModelFileError, load_arrays, save_arrays
from numpy_cae.errors import FileError, NumpyCaeError
from numpy_cae.models.sequential_autoencoder import Weights
from numpy_cae.training.optimisers import Adam, Sgd, rate_at
from numpy_cae.training.schedule import SequenceSchedule, Stage

FORMAT = "numpy_cae checkpoint 5"
POSITION = ("stage", "epoch", "step", "total", "losses", "seconds")
"""POSITION: what says in a `TrainingState` where a training stands, and what it has measured."""

HELD_OUT = "held-out error, cm"
"""HELD_OUT: the name in the losses of the errors on takes that are not trained on, by epoch."""
ADVICE = "a lower rate (--rate) or, in Python, a bound on the norm (`Stage.norm`) may help"


class DivergedError(NumpyCaeError, ArithmeticError):
    """Training whose loss or weights are no longer finite."""


@dataclass(eq=False)
class TrainingState:
    """Everything that the rest of a training depends on, and its loop over epochs and batches; and
    what the training has measured.

    `losses` holds, for each stage by name, the mean loss of every epoch. `train_sequential` adds
    the two terms of the loss of every step, "reconstruction" and "discrepancy". `seconds` holds the
    duration of each stage. A `Checkpoint` saves and loads the state.

    A function `report` gets the state after every step. `epoch` and `step` count what is done, so
    `step` is 0 after the last step of an epoch, whose mean loss is then the last of
    `losses[name]`.

    Examples
    --------
    >>> state = TrainingState({"w": np.zeros(3)}, np.random.default_rng(0))
    >>> x, stage = np.ones((3, 8, 5)), Stage(epochs=1, batch=2)
    >>> for step, rate in state.steps_of("layer 1", stage, state.weights, len(x)):
    ...     batch = x[2 * step : 2 * step + 2]
    ...     state.end_step(1.0 if step == 0 else 4.0, batch, rate)
    >>> state.stage, state.losses
    (1, {'layer 1': [2.0]})
    """

    weights: Weights  # all weights of the model, which training changes in place
    rng: np.random.Generator
    losses: dict[str, list[float]] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)
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
    checkpoint: Checkpoint | None = None
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
        self.losses.setdefault(name, [])
        self.started = time.perf_counter() - self.seconds.setdefault(name, 0.0)
        for epoch in range(self.epoch, stage.epochs):
            for step in range(self.step, self.steps):
                yield step, rate_at(stage, epoch, step, self.steps)
                if self.checkpoint is not None:
                    self.checkpoint.save_when_due(self)
        self.stage += 1
        self.epoch = 0

    def end_step(self, loss: float, x: np.ndarray, rate: float) -> None:
        """Count a step with the mean loss of the examples x, and the epoch if the step ends it.

        Raises DivergedError if the loss is not finite or, since a finite loss can precede infinite
        weights, if a weight is not finite at the end of an epoch.
        """
        last = self.step + 1 == self.steps
        if not np.isfinite(loss) or (last and nonfinite(self.weights)):
            raise DivergedError(self._diverged(loss, x, rate))
        self.loss = loss
        self.total += loss * len(x)
        self.step += 1
        self.seconds[self.name] = time.perf_counter() - self.started
        if last:
            self.losses[self.name].append(self.total / self.examples)
            self.epoch += 1
            self.step = 0
            self.total = 0.0

    def _diverged(self, loss: float, x: np.ndarray, rate: float) -> str:
        """The message names the first array, from the input x on, that is not finite."""
        parts = [*nonfinite({"the input": x} | self.weights), f"the output of {self.name}"]
        where = f"{self.name}, epoch {self.epoch + 1}, step {self.step + 1}"
        problem = f"the loss is {loss:.4g} at rate {rate:.4g}; not finite: {parts[0]}"
        saved = self.checkpoint.status() if self.checkpoint else "there is no checkpoint"
        return f"{where}: {problem}; {saved}; {ADVICE}"


def nonfinite(arrays: dict[str, np.ndarray]) -> list[str]:
    """The names of the arrays that hold a number that is not finite."""
    return [name for name, array in arrays.items() if not np.isfinite(array).all()]


class CheckpointError(NumpyCaeError, ValueError):
    """A checkpoint that cannot be continued from, or cannot be written."""


class Checkpoint:
    """The file of one run: the state after every epoch, and within one every `seconds` seconds.

    Without `resume` an existing file is an error, since it may be hours of training.

    Examples
    --------
    >>> checkpoint = Checkpoint("model.checkpoint.npz", seconds=60)
    >>> checkpoint.status()  # train_autoencoder(model, windows, checkpoint=checkpoint)
    'no state has been saved yet'
    """

    def __init__(self, path: str | Path, seconds: float = 60.0, resume: bool = False):
        self.path = Path(path)
        self.seconds = seconds
        self.resume = resume
        self.run = ""
        self.position = ""
        self.last = time.monotonic()

    def load_into(self, state: TrainingState, data: np.ndarray, *settings: object) -> None:
        """Continue from the file if there is one; the data, the settings, the weights and the
        generator identify the run.

        Raises CheckpointError if the file is of another run or damaged.
        """
        state.checkpoint = self
        digest = hashlib.blake2b(digest_size=16)
        digest.update(repr((*settings, state.rng.bit_generator.state)).encode())
        for array in (*state.weights.values(), data):
            digest.update(repr((array.shape, array.dtype)).encode())
            digest.update(np.ascontiguousarray(array).data)
        self.run = digest.hexdigest()
        self.require_none_unless_resumed()
        if not self.path.exists():
            return

        try:
            arrays = load_arrays(self.path, "a checkpoint", [FORMAT])
        except ModelFileError as error:
            advice = "it is not a checkpoint of this version, or damaged: remove it to start again"
            raise CheckpointError(f"{error}; {advice}") from None
        about = json.loads(str(arrays["about"]))
        if about["run"] != self.run:
            other = "is of a run with other motions, settings or seed"
            raise CheckpointError(f"{self.path}: {other}; give the same again or remove the file")
        for name in POSITION:
            setattr(state, name, about[name])
        state.rng.bit_generator.state = about["rng"]
        state.order = arrays["order"]
        # The stage does not have its optimiser yet: `steps_of` restores that.
        state.restored = {name.removeprefix("array "): array for name, array in arrays.items()}
        for name, weight in state.weights.items():
            weight[...] = state.restored[name]

    def require_none_unless_resumed(self) -> None:
        """Raise CheckpointError if there is a file and `resume` is False."""
        if self.path.exists() and not self.resume:
            advice = "continue it (--resume) or remove the file"
            raise CheckpointError(f"{self.path}: is of a run that was interrupted; {advice}")

    def save_when_due(self, state: TrainingState) -> None:
        """Save at the end of an epoch, or if the last save is old; never weights that are not
        finite."""
        due = state.step == 0 or time.monotonic() - self.last >= self.seconds
        if due and not nonfinite(state.weights):
            self.save(state)

    def save(self, state: TrainingState) -> None:
        """Replace the state in the file; CheckpointError, and no change, if that is impossible."""
        about = {name: getattr(state, name) for name in POSITION}
        about |= {"run": self.run, "rng": state.rng.bit_generator.state}
        words = {"format": np.array(FORMAT), "about": np.array(json.dumps(about))}
        arrays = {f"array {name}": a for name, a in (state.weights | state.optimiser.state).items()}
        arrays |= words | {"order": state.order}
        # Until the save succeeds, it is unknown whether the old or the new state is in the file.
        before = self.position
        self.position = ""
        try:
            save_arrays(arrays, self.path, compressed=False)
        except FileError as error:
            self.position = before
            advice = "Correct that and continue with --resume"
            raise CheckpointError(f"{error}; {self.status()}. {advice}") from error
        done = f"{state.epoch} epochs and {state.step} steps done"
        self.position = f" ({state.name}, {done})"
        self.last = time.monotonic()

    def status(self) -> str:
        """Where the last good state is, for a message."""
        if not self.path.exists():
            return "no state has been saved yet"
        return f"the last good state is in {self.path}{self.position}"
