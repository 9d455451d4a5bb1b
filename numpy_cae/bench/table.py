"""The table of `numpy-cae bench`: every case and batch size, with PyTorch if it is installed."""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.bench import arithmetic
from numpy_cae.bench.convolutional import (
    TorchModel,
    arrays_of,
    cases,
    require_agreement,
    torch,
)
from numpy_cae.bench.sequential import FRAMES, LATENT, SequenceCase, TorchSequenceModel
from numpy_cae.bench.timing import Timing, time_alternately
from numpy_cae.fast import accelerate
from numpy_cae.fast.blas import blas_threads
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder

BATCHES = (1, 4, 16, 64)
SEQUENCE_BATCHES = (16, 64)
HIDDEN = (128, 512, 1024)
"""Hidden units of the timed sequential networks."""

CHECKED_WINDOWS, CHECKED_HIDDEN = 4, 24
"""Sizes with which PyTorch's results are compared, in float64; larger ones would take longer."""


@dataclass(frozen=True)
class Row:
    """A timed case.

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
        Of the whole batch; `theirs` is None without PyTorch.
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
    """The versions, the numbers of threads, and the names of the columns."""
    versions = f"NumPy {np.__version__}, {blas_threads() or 'unknown'} BLAS threads, "
    versions += f"matrix-product peak {peak / 1e9:.0f} GFLOP/s"
    if torch is not None:
        versions += f"; PyTorch {torch.__version__}, {torch.get_num_threads()} threads"
    names = ["what            ", "  B", "ms a window   ", "of peak", "MB   "]
    if torch is not None:
        names += ["PyTorch, ms   ", "ratio"]
    return f"{versions}\n\n| {' | '.join(names)} |\n|{'---|' * len(names)}"


def rows(peak: float, batches: Sequence[int] | None = None, rounds: int = 21) -> Iterator[Row]:
    """Time every case of the convolutional network, yielding each row when it is known.

    Raises
    ------
    ArithmeticError
        If PyTorch computes something else.
    """
    if torch is not None:
        exact = accelerate(ConvAutoencoder(dtype=np.float64))
        for case in cases(exact, CHECKED_WINDOWS):
            require_agreement(case.name, arrays_of(exact, case), TorchModel(exact).arrays(case))
    for batch in batches or BATCHES:
        model = accelerate(ConvAutoencoder())
        for case in cases(model, batch):
            memory = peak_memory(case.function(accelerate(ConvAutoencoder())))
            theirs = None if torch is None else TorchModel(model).function(case)
            times = _times(case.function(model), theirs, rounds)
            yield Row(case.name, batch, case.operations, peak, memory, *times)


def sequence_rows(
    peak: float, batches: Sequence[int] | None = None, rounds: int = 21
) -> Iterator[Row]:
    """Time a training step of the sequential network at every width, as `rows`."""
    batches = batches or SEQUENCE_BATCHES
    if torch is not None:
        exact = SequentialAutoencoder(hidden=CHECKED_HIDDEN, latent=LATENT, dtype=np.float64)
        exact = accelerate(exact)
        for batch in batches:
            case = SequenceCase.drawn(exact, batch)
            theirs = TorchSequenceModel(exact).arrays(case)
            require_agreement("sequential", case.arrays_of(exact), theirs)
    for batch in batches:
        for units in HIDDEN:
            model = accelerate(SequentialAutoencoder(hidden=units, latent=LATENT))
            case = SequenceCase.drawn(model, batch)
            memory = peak_memory(case.function(model))
            theirs = None if torch is None else TorchSequenceModel(model).function(case)
            times = _times(case.function(model), theirs, rounds)
            operations = batch * arithmetic.sequence_step(model, FRAMES)
            yield Row(f"hidden {units}", batch, operations, peak, memory, *times)


def _times(
    ours: Callable[[], object], theirs: Callable[[], object] | None, rounds: int
) -> tuple[Timing, Timing | None]:
    functions = {"ours": ours} if theirs is None else {"ours": ours, "theirs": theirs}
    times = time_alternately(functions, rounds)
    return times["ours"], times.get("theirs")


def peak_memory(function: Callable[[], object]) -> int:
    """The most bytes of Python's and NumPy's memory that are in use at once while it runs."""
    gc.collect()
    tracemalloc.start()
    try:
        function()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
