"""A training that can be interrupted: it locks its output and saves its state beside it."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from numpy_cae.atomic_write import remove_leftovers
from numpy_cae.lock import lock
from numpy_cae.training import Checkpoint


@contextmanager
def one_run(output: Path, seconds: float, resume: bool) -> Iterator[Checkpoint]:
    """Yield the checkpoint of the run that writes `output`, under a lock.

    Raises FileError if another process writes there, CheckpointError if a run was interrupted and
    `resume` is False.
    """
    checkpoint = Checkpoint(state_of(output), seconds, resume)
    with lock(output), _stopped_by_sigterm():
        checkpoint.require_none_unless_resumed()
        remove_leftovers(output)
        try:
            yield checkpoint
        except KeyboardInterrupt:
            advice = "; continue with --resume" if checkpoint.path.exists() else ""
            raise KeyboardInterrupt(f"{checkpoint.status()}{advice}") from None


def state_of(output: Path) -> Path:
    """The file in which the state of a run is saved."""
    return output.with_name(f"{output.stem}.checkpoint.npz")


@contextmanager
def _stopped_by_sigterm() -> Iterator[None]:
    """Let SIGTERM end training as Ctrl-C does: with a message, without half-written files."""
    try:
        before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    except ValueError:  # signals can only be handled in the main thread
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
