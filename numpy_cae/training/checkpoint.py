"""How far training has come, kept in a file, so that an interrupted run can be gone on with.

What follows depends on the weights, the state of the random numbers, the order of this epoch's
windows and the place in it, and on nothing else: with these, a run that was interrupted ends in the
same bits as one that was not. The file is written beside its place, brought to the disk and
moved there, so that at every moment there is either the last good one or the one before.
"""

from __future__ import annotations

import hashlib
import io
import json
import os
import time
import zipfile
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from glob import escape
from pathlib import Path

import numpy as np

from numpy_cae.errors import NumpyCaeError

FORMAT = "numpy_cae checkpoint 1"


class CheckpointError(NumpyCaeError, ValueError):
    """A checkpoint that cannot be gone on with, or cannot be written."""


@dataclass
class State:
    """Everything that the rest of the training depends on.

    Parameters
    ----------
    weights : dict of arrays
    rng : dict
        `numpy.random.Generator.bit_generator.state`.
    stage, epoch, step : int
        How many of each are done: stages, epochs of this stage, steps of this epoch.
    total : float
        The sum of the losses in this epoch.
    order : array of int
        The windows in this epoch's order; empty between epochs and where clips are drawn.
    history : dict
        What has been measured, as JSON can say it.
    """

    weights: dict[str, np.ndarray]
    rng: dict
    stage: int = 0
    epoch: int = 0
    step: int = 0
    total: float = 0.0
    order: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    history: dict = field(default_factory=dict)


class Checkpoint:
    """The file of one run.

    Parameters
    ----------
    path : path
        Ends in .npz.
    seconds : float
        Within an epoch the state is kept so often; at the end of each epoch it always is.
    resume : bool
        Whether to go on from what the file holds. Where False a file that is there already is
        refused: it may be hours of somebody's training.
    """

    def __init__(self, path: str | Path, seconds: float = 60.0, resume: bool = False):
        self.path, self.seconds, self.resume = Path(path), seconds, resume
        self.run = ""
        self.kept: str | None = None
        self.last = time.monotonic()

    def begin(self, run: str) -> State | None:
        """Say which run this is (`run_of`); what to go on from, None to begin at the beginning.

        Raises
        ------
        CheckpointError
            If there is a file and it may not or cannot be gone on with.
        """
        self.run = run
        # What a killed run was writing when it was killed.
        for stale in self.path.parent.glob(f".{escape(self.path.stem)}.*.part"):
            stale.unlink(missing_ok=True)
        self.require_none_unless_resumed()
        return self._load() if self.path.exists() else None

    def require_none_unless_resumed(self) -> None:
        """Refuse a file that nobody asked to go on from; worth asking before motions are read."""
        if self.path.exists() and not self.resume:
            raise CheckpointError(
                f"{self.path}: is of a run that was interrupted; go on with it (--resume) or "
                "remove it"
            )

    def is_due(self) -> bool:
        """Whether the last state is older than `seconds`."""
        return time.monotonic() - self.last >= self.seconds

    def save(self, state: State) -> None:
        """Keep the state in place of the one before.

        Raises
        ------
        CheckpointError
            If the disk is full or the folder is read-only; the file is then as it was.
        """
        about = {
            "format": FORMAT,
            "run": self.run,
            "rng": state.rng,
            "stage": state.stage,
            "epoch": state.epoch,
            "step": state.step,
            "total": state.total,
            "history": state.history,
        }
        arrays = {f"weight {name}": array for name, array in state.weights.items()}
        beside = self.path.with_name(f".{self.path.stem}.{os.getpid()}.part")
        # In memory first: an archive that Ctrl-C leaves open writes its end when it is collected,
        # and would find the file closed.
        archive = io.BytesIO()
        np.savez(archive, about=np.array(json.dumps(about)), order=state.order, **arrays)
        try:
            with open(beside, "wb") as file:
                file.write(archive.getbuffer())
                file.flush()
                os.fsync(file.fileno())
            os.replace(beside, self.path)
        except OSError as error:
            beside.unlink(missing_ok=True)
            raise CheckpointError(
                f"{self.path}: cannot be written: {error.strerror}; {self.said()}. When that is "
                "mended, go on with --resume"
            ) from error
        self.kept = f"stage {state.stage + 1}, {state.epoch} epochs and {state.step} steps done"
        self.last = time.monotonic()

    def remove(self) -> None:
        """The training has ended and its model is kept: there is nothing to go on with."""
        self.path.unlink(missing_ok=True)

    def said(self) -> str:
        """Where the last good state is, for a message."""
        return (
            f"the last good state is in {self.path} ({self.kept})"
            if self.kept
            else ("no state has been kept yet")
        )

    def _load(self) -> State:
        try:
            with np.load(self.path, allow_pickle=False) as file:
                about = json.loads(str(file["about"]))
                arrays = {name: file[name] for name in file.files if name != "about"}
            if about["format"] != FORMAT:
                raise ValueError
            state = State(
                {name[7:]: array for name, array in arrays.items() if name.startswith("weight ")},
                *(about[name] for name in ("rng", "stage", "epoch", "step", "total")),
                arrays["order"],
                about["history"],
            )
        except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile, zlib.error, EOFError):
            raise CheckpointError(f"{self.path}: is no checkpoint of this version") from None
        if about["run"] != self.run:
            raise CheckpointError(
                f"{self.path}: is of a run with other motions, settings or seed; give those again "
                "or remove it"
            )
        self.kept = f"stage {state.stage + 1}, {state.epoch} epochs and {state.step} steps done"
        return state


def run_of(arrays: Iterable[np.ndarray], *settings: object) -> str:
    """A name for a run: the same for the same data, settings and seed, and for no other."""
    digest = hashlib.blake2b(repr(settings).encode(), digest_size=16)
    for array in arrays:
        digest.update(repr((array.shape, array.dtype)).encode())
        digest.update(np.ascontiguousarray(array).data)
    return digest.hexdigest()
