"""Functions timed in turn in many short rounds, so that all meet the same load of the machine."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

PAUSE_SECONDS = 0.03
"""The wait before each measurement (s): the threads of OpenMP and BLAS wait actively
for a while after their work is done, which would slow down the next function."""
MIN_SECONDS = 0.03
"""A measurement takes at least this (s); a faster function is called several times."""
Clock = Callable[[], float]


@dataclass(frozen=True, eq=False)
class Timing:
    """The seconds of one call, in each of many rounds."""

    seconds: np.ndarray

    @property
    def median(self) -> float:
        """Seconds."""
        return float(np.median(self.seconds))

    @property
    def least(self) -> float:
        """Seconds."""
        return float(self.seconds.min())


def time_alternately(
    functions: Mapping[str, Callable[[], object]], rounds: int, clock: Clock = time.perf_counter
) -> dict[str, Timing]:
    """Time every function once in each round; the result has the same names."""
    repeats = {name: _repeats(function, clock) for name, function in functions.items()}
    seconds: dict[str, list[float]] = {name: [] for name in functions}
    for _ in range(rounds):
        for name, function in functions.items():
            time.sleep(PAUSE_SECONDS)
            function()  # the caches hold the data of the function before
            start = clock()
            for _ in range(repeats[name]):
                function()
            seconds[name].append((clock() - start) / repeats[name])
    return {name: Timing(np.array(rounds)) for name, rounds in seconds.items()}


def _repeats(function: Callable[[], object], clock: Clock) -> int:
    """Calls in one measurement; also a first call, which is slower."""
    function()
    start = clock()
    function()
    return max(1, round(MIN_SECONDS / max(clock() - start, 1e-9)))
