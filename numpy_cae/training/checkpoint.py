"""The file of a training, from which an interrupted run continues.

It holds everything that the rest of the training depends on: weights, optimiser, random numbers,
the order of the epoch's examples and the position in it. A resumed run is therefore bit-identical
to one that was not interrupted.
"""

from __future__ import annotations

import hashlib
import json
import time
from pathlib import Path

import numpy as np

from numpy_cae.array_file import ModelFileError, load_arrays, save_arrays
from numpy_cae.atomic_write import replacing
from numpy_cae.errors import FileError, NumpyCaeError
from numpy_cae.models.sequential_autoencoder import Weights
from numpy_cae.training.state import POSITION, TrainingState
from numpy_cae.training.windows import Windows

FORMAT = "numpy_cae checkpoint 6"
"""The only format that is read; a training of another version has to be started again."""


class CheckpointError(NumpyCaeError, ValueError):
    """A checkpoint that cannot be continued from, or cannot be written."""


class Checkpoint:
    """The file of one run: the state after every epoch, and within one every `seconds` seconds.

    Without `resume` an existing file is an error, since it may be hours of training. Training
    changes its arrays and its generator in place; `begin_run` and `begin_stage` tell the checkpoint
    which they are.

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
        self.saved = ""  # what the file holds, for a message
        self.last_save = time.monotonic()
        self.rng = np.random.default_rng()
        self.weights: Weights = {}
        self.stage_arrays: dict[str, np.ndarray] = {}
        self.loaded: dict[str, np.ndarray] = {}  # from the file, until the stage has begun

    def begin_run(
        self,
        state: TrainingState,
        rng: np.random.Generator,
        weights: Weights,
        data: np.ndarray | Windows,
        *settings: object,
    ) -> None:
        """Save the generator and the weights of a run; continue from the file if there is one.

        The data, the settings, the weights and the generator identify the run. Raises
        CheckpointError if the file is of another run or damaged.
        """
        self.rng = rng
        self.weights = weights
        self.run = _digest(rng, [*weights.values(), data], settings)
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
            problem = "is of a run with other motions, settings or seed"
            advice = "give the same again or remove the file"
            raise CheckpointError(f"{self.path}: {problem}; {advice}")
        for name in POSITION:
            setattr(state, name, about[name])
        rng.bit_generator.state = about["rng"]
        self.loaded = {name.removeprefix("array "): array for name, array in arrays.items()}
        for name, weight in weights.items():
            weight[...] = self.loaded[name]

    def begin_stage(self, arrays: dict[str, np.ndarray]) -> None:
        """Save these arrays of a stage, too; if the run is continued in this stage, restore them.

        They are the optimiser's and the order of the examples, which only exist in their stage.
        """
        self.stage_arrays = arrays
        if self.loaded:
            for name, array in arrays.items():
                array[...] = self.loaded[name]
        self.loaded = {}

    def require_none_unless_resumed(self) -> None:
        """Raise CheckpointError if there is a file and `resume` is False."""
        if self.path.exists() and not self.resume:
            advice = "continue it (--resume) or remove the file"
            raise CheckpointError(f"{self.path}: is of a run that was interrupted; {advice}")

    def save_when_due(self, state: TrainingState) -> None:
        """Save at the end of an epoch, or if the last save is old; never weights that are not
        finite."""
        is_due = state.step == 0 or time.monotonic() - self.last_save >= self.seconds
        if is_due and all(np.isfinite(weight).all() for weight in self.weights.values()):
            self.save(state)

    def save(self, state: TrainingState) -> None:
        """Replace the state in the file; CheckpointError, and no change, if that is impossible."""
        about = {name: getattr(state, name) for name in POSITION}
        about |= {"run": self.run, "rng": self.rng.bit_generator.state}
        arrays = {"format": np.array(FORMAT), "about": np.array(json.dumps(about))}
        for name, array in (self.weights | self.stage_arrays).items():
            arrays[f"array {name}"] = array
        # Until the save succeeds, it is unknown whether the old or the new state is in the file.
        saved_before = self.saved
        self.saved = ""
        try:
            with replacing(True):  # `begin_run` has read what exists
                save_arrays(arrays, self.path, compressed=False)
        except FileError as error:
            self.saved = saved_before
            advice = "Correct that and continue with --resume"
            raise CheckpointError(f"{error}; {self.status()}. {advice}") from error
        self.saved = f" ({state.name}, {state.epoch} epochs and {state.step} steps done)"
        self.last_save = time.monotonic()

    def status(self) -> str:
        """Where the last good state is, for a message."""
        if not self.path.exists():
            return "no state has been saved yet"
        return f"the last good state is in {self.path}{self.saved}"


DIGESTED_ROWS = 64
"""The hash reads so many rows of an array at a time: windows are cut when they are read."""


def _digest(rng: np.random.Generator, arrays: list[np.ndarray | Windows], settings: tuple) -> str:
    """A hash of the generator's state, the arrays and the settings."""
    digest = hashlib.blake2b(digest_size=16)
    digest.update(repr((*settings, rng.bit_generator.state)).encode())
    for array in arrays:
        digest.update(repr((array.shape, array.dtype)).encode())
        for first in range(0, len(array), DIGESTED_ROWS):
            digest.update(np.ascontiguousarray(array[first : first + DIGESTED_ROWS]).data)
    return digest.hexdigest()
