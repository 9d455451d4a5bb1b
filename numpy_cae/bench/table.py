"""The table of `numpy-cae bench`: every case and batch size, with PyTorch if it is installed.

Functions are timed alternately, so that a change of the machine's speed affects all of them.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from numpy_cae.bench.convolutional import TorchModel, arrays_of, cases, require_agreement, torch
from numpy_cae.bench.peak import matrix_product_peak
from numpy_cae.fast import accelerate
from numpy_cae.fast.blas import blas_threads
from numpy_cae.models import ConvAutoencoder

PAUSE = 0.03
"""Seconds before each measurement: the threads of OpenMP and BLAS wait actively for a while after
their work is done, which would slow down the next function."""

MIN_SECONDS = 0.03
"""Seconds of one measurement; a faster function is called several times."""
BATCHES = (1, 4, 16, 64)
CHECKED_WINDOWS = 4
"""Windows with which PyTorch's results are compared, in float64; more would take longer."""


@dataclass(frozen=True)
class Timing:
    """The seconds of one call, in each of many rounds."""

    seconds: np.ndarray

    @property
    def median(self) -> float:
        """Seconds."""
        return float(np.median(self.seconds))

    @property
    def spread(self) -> float:
        """Half the interquartile range, as a share of the median."""
        low, high = np.quantile(self.seconds, (0.25, 0.75))
        return float((high - low) / 2 / self.median)


def time_alternately(
    functions: Mapping[str, Callable[[], object]], rounds: int
) -> dict[str, Timing]:
    """Time every function once in each round; the result has the same names."""
    repeats = {name: _repeats(function) for name, function in functions.items()}
    seconds: dict[str, list[float]] = {name: [] for name in functions}
    for _ in range(rounds):
        for name, function in functions.items():
            time.sleep(PAUSE)
            function()  # the caches hold the data of the function before
            start = time.perf_counter()
            for _ in range(repeats[name]):
                function()
            seconds[name].append((time.perf_counter() - start) / repeats[name])
    return {name: Timing(np.array(each)) for name, each in seconds.items()}


def _repeats(function: Callable[[], object]) -> int:
    """Calls in one measurement; also a first call, which is slower."""
    function()
    start = time.perf_counter()
    function()
    return max(1, round(MIN_SECONDS / max(time.perf_counter() - start, 1e-9)))


@dataclass(frozen=True)
class Row:
    """The times of a case, for the whole batch; `theirs` is None without PyTorch."""

    name: str
    batch: int
    ours: Timing
    theirs: Timing | None

    def text(self) -> str:
        """A line of the table."""
        line = f"| {self.name:16} | {self.batch:3} | {self._milliseconds(self.ours)} |"
        if self.theirs is not None:
            ratio = self.theirs.median / self.ours.median
            line += f" {self._milliseconds(self.theirs)} | {ratio:5.2f} |"
        return line

    def _milliseconds(self, timing: Timing) -> str:
        return f"{1e3 * timing.median / self.batch:7.3f} ± {timing.spread:4.0%}"


def header() -> str:
    """The versions, the numbers of threads, the speed of a matrix product, the columns' names."""
    versions = f"NumPy {np.__version__}, {blas_threads() or 'unknown'} BLAS threads, "
    versions += f"matrix-product peak {matrix_product_peak() / 1e9:.0f} GFLOP/s"
    names = ["what            ", "  B", "ms a window   "]
    if torch is not None:
        versions += f"; PyTorch {torch.__version__}, {torch.get_num_threads()} threads"
        names += ["PyTorch, ms   ", "ratio"]
    return f"{versions}\n\n| {' | '.join(names)} |\n|{'---|' * len(names)}"


def rows(batches: Sequence[int] | None = None, rounds: int = 21) -> Iterator[Row]:
    """Time every case of the convolutional network, yielding each row when it is known.

    Raises ArithmeticError if PyTorch computes something else.
    """
    if torch is not None:
        exact = accelerate(ConvAutoencoder(dtype=np.float64))
        for case in cases(exact, CHECKED_WINDOWS):
            require_agreement(case.name, arrays_of(exact, case), TorchModel(exact).arrays(case))
    for batch in batches or BATCHES:
        model = accelerate(ConvAutoencoder())
        for case in cases(model, batch):
            yield timed_row(case.name, batch, model, TorchModel, case, rounds)


def timed_row(
    name: str, batch: int, model: Any, torch_model: Callable, case: Any, rounds: int
) -> Row:
    """Time one case, here and in PyTorch."""
    functions = {"ours": case.function(model)}
    if torch is not None:
        functions["theirs"] = torch_model(model).function(case)
    times = time_alternately(functions, rounds)
    return Row(name, batch, times["ours"], times.get("theirs"))
