"""The state of a training in a file, from which an interrupted run continues."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from numpy_cae.array_file import ModelFileError, load_arrays, save_arrays, text
from numpy_cae.atomic_write import remove_leftovers
from numpy_cae.errors import FileError, NumpyCaeError

FORMAT = "numpy_cae checkpoint 2"


class CheckpointError(NumpyCaeError, ValueError):
    """A checkpoint that cannot be continued from, or cannot be written."""


@dataclass
class Position:
    """How far training is.

    Parameters
    ----------
    stage, epoch, step : int
        How many of each are done: stages, epochs of this stage, steps of this epoch.
    total : float
        The sum of the losses of this epoch's examples so far.
    seconds : float
        Time spent on this stage.
    order : array of int
        The examples in this epoch's order; empty between epochs.
    """

    stage: int = 0
    epoch: int = 0
    step: int = 0
    total: float = 0.0
    seconds: float = 0.0
    order: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))


@dataclass
class State:
    """Everything that the rest of the training depends on.

    Parameters
    ----------
    arrays : dict of name to array
        The weights and the state of the optimiser.
    rng : dict
        `numpy.random.Generator.bit_generator.state`.
    position : Position
    history : dict
        What has been measured, in types that JSON can hold.
    """

    arrays: dict[str, np.ndarray]
    rng: dict
    position: Position
    history: dict


class Checkpoint:
    """The file of one run.

    Parameters
    ----------
    path : path
        Ends in .npz.
    seconds : float
        Time between two states that are saved within an epoch; one is saved after every epoch.
    resume : bool
        Whether to continue from what the file holds. If False, an existing file is an error,
        since it may be hours of training.
    """

    def __init__(self, path: str | Path, seconds: float = 60.0, resume: bool = False):
        self.path, self.seconds, self.resume = Path(path), seconds, resume
        self.run = ""
        self.saved: str | None = None
        self.last = time.monotonic()

    def begin(self, run: str) -> State | None:
        """Return the state of this run (`fingerprint`) to continue from; None where there is none.

        Raises
        ------
        CheckpointError
            If there is a file and it may not or cannot be continued from.
        """
        self.run = run
        remove_leftovers(self.path)
        self.require_none_unless_resumed()
        return self._load() if self.path.exists() else None

    def require_none_unless_resumed(self) -> None:
        """Raise CheckpointError if there is a file and `resume` is False."""
        if self.path.exists() and not self.resume:
            raise CheckpointError(
                f"{self.path}: is of a run that was interrupted; continue it (--resume) or "
                "remove the file"
            )

    def is_due(self) -> bool:
        """Whether the last state is older than `seconds`."""
        return time.monotonic() - self.last >= self.seconds

    def save(self, state: State) -> None:
        """Replace the state in the file.

        Raises
        ------
        CheckpointError
            If the disk is full or the folder is read-only; the file is then unchanged.
        """
        position = dict(vars(state.position))
        order = position.pop("order")
        about = {
            "run": self.run,
            "rng": state.rng,
            "position": position,
            "history": state.history,
        }
        arrays = {f"array {name}": array for name, array in state.arrays.items()}
        arrays |= {"format": np.array(FORMAT), "about": np.array(json.dumps(about)), "order": order}
        try:
            save_arrays(arrays, self.path, compressed=False)
        except FileError as error:
            raise CheckpointError(
                f"{error}; {self.status()}. Correct that and continue with --resume"
            ) from error
        self.saved = _describe(state.position)
        self.last = time.monotonic()

    def remove(self) -> None:
        """Remove the file: the training has ended and its model is saved."""
        self.path.unlink(missing_ok=True)

    def status(self) -> str:
        """Where the last good state is, for a message."""
        if self.saved is None:
            return "no state has been saved yet"
        return f"the last good state is in {self.path} ({self.saved})"

    def _load(self) -> State:
        try:
            run, state = load_arrays(self.path, FORMAT, _assemble)
        except ModelFileError:
            raise CheckpointError(f"{self.path}: is not a checkpoint of this version") from None
        if run != self.run:
            raise CheckpointError(
                f"{self.path}: is of a run with other motions, settings or seed; give the same "
                "again or remove the file"
            )
        self.saved = _describe(state.position)
        return state


def fingerprint(arrays: Iterable[np.ndarray], *settings: object) -> str:
    """Identifies a run: the same for the same data, settings and seed, and for no others."""
    digest = hashlib.blake2b(repr(settings).encode(), digest_size=16)
    for array in arrays:
        digest.update(repr((array.shape, array.dtype)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()


def _assemble(arrays: dict[str, np.ndarray]) -> tuple[str, State]:
    about = text(arrays, "about")
    named = {
        name.removeprefix("array "): array
        for name, array in arrays.items()
        if name.startswith("array ")
    }
    position = Position(**about["position"], order=arrays["order"])
    return about["run"], State(named, about["rng"], position, about["history"])


def _describe(position: Position) -> str:
    return f"stage {position.stage + 1}, {position.epoch} epochs and {position.step} steps done"
