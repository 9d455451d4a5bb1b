"""Functions timed alternately, so that a change of the machine's speed affects all of them."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

PAUSE = 0.03
"""Seconds before each measurement: the threads of OpenMP and BLAS wait actively for a while after
their work is done, which would slow down the next function."""

MIN_SECONDS = 0.03
"""Seconds of one measurement; a faster function is called several times."""


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
