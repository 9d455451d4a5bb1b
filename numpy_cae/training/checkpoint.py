"""The state of a training in a file, from which an interrupted run continues.

The state is everything that the rest of the training depends on: weights, optimiser, random
numbers, the order of the epoch's examples and the position in it. A resumed run is therefore
bit-identical to one that was not interrupted.
"""

import hashlib
import json
import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from numpy_cae.array_file import ModelFileError, load_arrays, save_arrays
from numpy_cae.errors import FileError, NumpyCaeError
from numpy_cae.training.loop import History, TrainingState

FORMAT = "numpy_cae checkpoint 5"
POSITION = ("stage", "epoch", "step", "total")


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

    def load_into(self, state: TrainingState, run: str) -> None:
        """Continue from the file if there is one; `run` is the `fingerprint` of this training.

        Raises CheckpointError if the file is of another run or damaged.
        """
        self.run = run
        state.save = self.save_when_due
        state.saved = self.status
        self.require_none_unless_resumed()
        if not self.path.exists():
            return

        try:
            arrays = load_arrays(self.path, [FORMAT])
        except ModelFileError as error:
            advice = "it is not a checkpoint of this version, or damaged: remove it to start again"
            raise CheckpointError(f"{error}; {advice}") from None
        about = json.loads(str(arrays["about"]))
        if about["run"] != run:
            other = "is of a run with other motions, settings or seed"
            raise CheckpointError(f"{self.path}: {other}; give the same again or remove the file")
        for name in POSITION:
            setattr(state, name, about[name])
        state.history = History(about["losses"], about["seconds"])
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
        if due and all(np.isfinite(array).all() for array in state.weights.values()):
            self.save(state)

    def save(self, state: TrainingState) -> None:
        """Replace the state in the file; CheckpointError, and no change, if that is impossible."""
        # Until the save succeeds, it is unknown whether the old or the new state is in the file.
        before = self.position
        self.position = ""
        try:
            save_arrays(_arrays_of(state, self.run), self.path, compressed=False)
        except FileError as error:
            self.position = before
            advice = "Correct that and continue with --resume"
            raise CheckpointError(f"{error}; {self.status()}. {advice}") from error
        done = f"{state.epoch} epochs and {state.step} steps done"
        self.position = f" ({state.name}, {done})"
        self.last = time.monotonic()

    def remove(self) -> None:
        """Remove the file: the training has ended and its model is saved."""
        self.path.unlink(missing_ok=True)

    def status(self) -> str:
        """Where the last good state is, for a message."""
        if not self.path.exists():
            return "no state has been saved yet"
        return f"the last good state is in {self.path}{self.position}"


def _arrays_of(state: TrainingState, run: str) -> dict[str, np.ndarray]:
    """The state as named arrays; numbers and lists are one array of JSON text."""
    about = {name: getattr(state, name) for name in POSITION}
    about |= {"losses": state.history.losses, "seconds": state.history.seconds}
    about |= {"run": run, "rng": state.rng.bit_generator.state}
    arrays = {f"array {name}": a for name, a in (state.weights | state.optimiser.state).items()}
    words = {"format": np.array(FORMAT), "about": np.array(json.dumps(about))}
    return arrays | words | {"order": state.order}


def fingerprint(arrays: Iterable[np.ndarray], *settings: object) -> str:
    """Identifies a run: the same for the same data, settings and seed, and for no others."""
    digest = hashlib.blake2b(repr(settings).encode(), digest_size=16)
    for array in arrays:
        digest.update(repr((array.shape, array.dtype)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
