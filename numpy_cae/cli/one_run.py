"""A training that may be interrupted: alone on its output, its state kept beside it."""

from __future__ import annotations

import argparse
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from numpy_cae.atomic_write import remove_leftovers
from numpy_cae.cli import arguments as kinds
from numpy_cae.lock import lock
from numpy_cae.training import Checkpoint


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """How often the state is kept, and going on from it."""
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on from MODEL.checkpoint.npz, which an interrupted run leaves, to the same bits",
    )
    parser.add_argument(
        "--checkpoint",
        type=kinds.rate,
        default=60.0,
        metavar="SECONDS",
        help="keep the state so often; after every epoch it always is",
    )


@contextmanager
def one_run(output: Path, seconds: float, resume: bool) -> Iterator[Checkpoint]:
    """The checkpoint of the run that writes `output`, while no other process writes there.

    Raises
    ------
    MotionFileError
        If another process does.
    CheckpointError
        If a run was interrupted and `resume` is not asked for.
    """
    checkpoint = Checkpoint(state_of(output), seconds, resume)
    with lock(output), _stopped_by_sigterm():
        checkpoint.require_none_unless_resumed()
        remove_leftovers(output)
        yield checkpoint


def state_of(output: Path) -> Path:
    """Where the state of a run is kept."""
    return output.with_name(f"{output.stem}.checkpoint.npz")


@contextmanager
def _stopped_by_sigterm() -> Iterator[None]:
    """SIGTERM ends training as Ctrl-C does: what is half written is removed, and it says so."""
    try:
        before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    except ValueError:  # not in the main thread, where signals are nobody's
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
