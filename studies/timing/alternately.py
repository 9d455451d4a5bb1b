"""Times of functions that are called alternately, so that a change of the machine's speed affects
all of them."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from timeit import repeat

import numpy as np

PAUSE_SECONDS = 0.03
"""PAUSE_SECONDS: the wait before each measurement (s): the threads of OpenMP and BLAS wait actively
for a while after their work is done, which would slow down the next function."""
MIN_SECONDS = 0.03
"""MIN_SECONDS: a measurement takes at least this (s); a faster function is called several times."""


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
            time.sleep(PAUSE_SECONDS)
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


def matrix_product_peak(size: int = 2048, rounds: int = 12) -> float:
    """Operations a second of a product of float32 (size, size) matrices, the best of the rounds."""
    a, b = np.random.default_rng(0).random((2, size, size), dtype=np.float32)
    out = np.empty_like(a)
    return 2 * size**3 / min(repeat(lambda: np.matmul(a, b, out=out), number=1, repeat=rounds))
