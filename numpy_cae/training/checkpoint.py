"""The state of a training in a file, from which an interrupted run continues."""

import hashlib
import json
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from numpy_cae.array_file import ModelFileError, json_object, load_arrays, save_arrays
from numpy_cae.errors import FileError, NumpyCaeError
from numpy_cae.training.loop import Callback, Loop, Position

FORMAT = "numpy_cae checkpoint 3"


class CheckpointError(NumpyCaeError, ValueError):
    """A checkpoint that cannot be continued from, or cannot be written."""


class Checkpoint(Callback):
    """The file of one run: the state after every epoch, and within one every so many seconds.
    Without `resume` an existing file is an error, since it may be hours of training."""

    def __init__(self, path: str | Path, seconds: float = 60.0, resume: bool = False):
        self.path, self.seconds, self.resume = Path(path), seconds, resume
        self.run, self.last = "", time.monotonic()
        self.saved: Position | None = None

    def attach(self, loop: Loop, run: str) -> None:
        """Continue the loop from the file, where there is one, and save its states from now on; a
        file whose `run`, the `fingerprint`, is another raises CheckpointError."""
        self.run = run
        self.require_none_unless_resumed()
        if self.path.exists():
            self._resume(loop)
        loop.callbacks.append(self)

    def require_none_unless_resumed(self) -> None:
        """Raise CheckpointError if there is a file and `resume` is False."""
        if self.path.exists() and not self.resume:
            advice = "continue it (--resume) or remove the file"
            raise CheckpointError(f"{self.path}: is of a run that was interrupted; {advice}")

    def after_step(self, loop: Loop) -> None:
        """Save the state if the last one is old, but never one whose weights are not finite."""
        old = loop.position.step < loop.steps and time.monotonic() - self.last >= self.seconds
        if old and all(np.isfinite(array).all() for array in loop.parameters.values()):
            self.save(loop)

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """Save the state; `DivergenceCheck` comes before and has checked the weights."""
        self.save(loop)

    def save(self, loop: Loop) -> None:
        """Replace the state in the file; CheckpointError, and no change, if that is impossible."""
        position = dict(vars(loop.position))
        state = loop.parameters | loop.task.optimiser.state
        arrays = {f"array {name}": array for name, array in state.items()}
        arrays |= {"format": np.array(FORMAT), "order": position.pop("order")}
        rng, history = loop.rng.bit_generator.state, vars(loop.history)
        about = {"run": self.run, "rng": rng, "position": position, "history": history}
        arrays["about"] = np.array(json.dumps(about))
        before, self.saved = self.saved, None  # while it is unknown which of the two is in the file
        try:
            save_arrays(arrays, self.path, compressed=False)
        except FileError as error:
            self.saved = before
            advice = "Correct that and continue with --resume"
            raise CheckpointError(f"{error}; {self.status()}. {advice}") from error
        self.saved, self.last = Position(**position), time.monotonic()

    def remove(self) -> None:
        """Remove the file: the training has ended and its model is saved."""
        self.path.unlink(missing_ok=True)

    def status(self) -> str:
        """Where the last good state is, for a message."""
        if not self.path.exists():
            return "no state has been saved yet"
        at, done = self.saved, ""
        if at is not None:
            done = f" (stage {at.stage + 1}, {at.epoch} epochs and {at.step} steps done)"
        return f"the last good state is in {self.path}{done}"

    def _resume(self, loop: Loop) -> None:
        """Continue the loop from the file."""

        def resume(arrays: dict[str, np.ndarray]) -> Position | None:
            about, prefix = json_object(arrays, "about"), "array "
            if about["run"] != self.run:
                return None
            state = {name.removeprefix(prefix): array for name, array in arrays.items()}
            position = Position(**about["position"], order=arrays["order"])
            loop.resume(position, state, about["rng"], about["history"])
            return replace(position)

        try:
            self.saved = load_arrays(self.path, {FORMAT: resume})
        except ModelFileError as error:
            advice = "it is not a checkpoint of this version, or damaged: remove it to start again"
            raise CheckpointError(f"{error}; {advice}") from None
        if self.saved is None:
            advice = "give the same again or remove the file"
            other = "is of a run with other motions, settings or seed"
            raise CheckpointError(f"{self.path}: {other}; {advice}")


def fingerprint(arrays: Iterable[np.ndarray], *settings: object) -> str:
    """Identifies a run: the same for the same data, settings and seed, and for no others."""
    digest = hashlib.blake2b(repr(settings).encode(), digest_size=16)
    for array in arrays:
        digest.update(repr((array.shape, array.dtype)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
