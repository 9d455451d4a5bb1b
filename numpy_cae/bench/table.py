"""The table of `numpy-cae bench`: every case and batch, beside the machine and PyTorch."""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.bench.cases import Case, cases
from numpy_cae.bench.timing import Timing, time_in_turns
from numpy_cae.bench.torch_twin import TorchTwin, require_agreement, torch
from numpy_cae.fast import accelerate
from numpy_cae.fast.blas import blas_threads
from numpy_cae.models import ConvAutoencoder

BATCHES = (1, 4, 16, 64)
CHECKED = 4
"""Windows with which PyTorch is checked; more would only take longer in float64."""


@dataclass(frozen=True)
class Row:
    """One thing that was timed, at one size of batch.

    Parameters
    ----------
    name : str
    batch : int
    operations : int
        Of the direct form, for the whole batch.
    peak : float
        Operations a second of a large matrix product.
    memory : int
        Bytes.
    ours, theirs : Timing
        Of the whole batch; None where PyTorch is not installed.
    """

    name: str
    batch: int
    operations: int
    peak: float
    memory: int
    ours: Timing
    theirs: Timing | None

    def text(self) -> str:
        """A line of the table."""
        rate = self.operations / self.ours.median
        columns = [
            f"| {self.name:16} | {self.batch:3} ",
            f"| {1e3 * self.ours.median / self.batch:7.3f} ± {self.ours.spread:4.0%} ",
            f"| {rate / self.peak:5.0%} | {self.memory / 1e6:5.0f} ",
        ]
        if self.theirs is not None:
            columns.append(
                f"| {1e3 * self.theirs.median / self.batch:7.3f} ± {self.theirs.spread:4.0%} "
                f"| {self.theirs.median / self.ours.median:5.2f} "
            )
        return "".join(columns) + "|"


def header(peak: float) -> str:
    """What the figures were measured with, and what the columns are."""
    said = f"NumPy {np.__version__}, {blas_threads() or 'unknown'} BLAS threads, "
    said += f"matrix-product peak {peak / 1e9:.0f} GFLOP/s"
    if torch is not None:
        said += f"; PyTorch {torch.__version__}, {torch.get_num_threads()} threads"
    names = ["what            ", "  B", "ms a window   ", "of peak", "MB   "]
    if torch is not None:
        names += ["PyTorch, ms   ", "ratio"]
    return f"{said}\n\n| {' | '.join(names)} |\n|{'---|' * len(names)}"


def rows(peak: float, batches: Sequence[int] = BATCHES, rounds: int = 21) -> Iterator[Row]:
    """Time everything; a row as soon as it is known.

    Raises
    ------
    ArithmeticError
        If PyTorch is installed and computes something else.
    """
    if torch is not None:
        _check()
    for batch in batches:
        model = ConvAutoencoder()
        for case in cases(model, batch):
            yield _row(model, case, peak, rounds)


def _row(model: ConvAutoencoder, case: Case, peak: float, rounds: int) -> Row:
    memory = _memory(case)
    functions = {"ours": case.ours(accelerate(model))}
    if torch is not None:
        functions["theirs"] = TorchTwin(model).theirs(case)
    times = time_in_turns(functions, rounds)
    ours, theirs = times["ours"], times.get("theirs")
    return Row(case.name, len(case.x), case.operations, peak, memory, ours, theirs)


def _check() -> None:
    model = ConvAutoencoder(dtype=np.float64)
    for case in cases(model, CHECKED):
        require_agreement(model, case)


def _memory(case: Case) -> int:
    """The most that a model which has done nothing yet allocates for the case, bytes."""
    return peak_memory(case.ours(accelerate(ConvAutoencoder())))


def peak_memory(function: Callable[[], object]) -> int:
    """The most bytes of Python's and NumPy's memory that are in use at once while it runs."""
    gc.collect()
    tracemalloc.start()
    try:
        function()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
