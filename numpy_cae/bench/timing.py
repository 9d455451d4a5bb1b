"""Functions timed in turns, so that a machine that slows down slows all of them down."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

REST = 0.03
"""Seconds before each turn: the threads of OpenMP and BLAS go on spinning for a while after their
work is done, and would take the processor from whoever has the next turn."""


@dataclass(frozen=True)
class Timing:
    """Seconds of many rounds.

    Parameters
    ----------
    seconds : (rounds,) array
    """

    seconds: np.ndarray

    @property
    def median(self) -> float:
        """Half of the rounds took longer."""
        return float(np.median(self.seconds))

    @property
    def spread(self) -> float:
        """Half the distance between the quartiles, as a share of the median."""
        low, high = np.quantile(self.seconds, (0.25, 0.75))
        return float((high - low) / 2 / self.median)


def time_in_turns(functions: Mapping[str, Callable[[], object]], rounds: int) -> dict[str, Timing]:
    """Each function once a round, round after round; what is quick runs several times in a round.

    Parameters
    ----------
    functions : name to function without arguments
    rounds : int

    Returns
    -------
    dict, name to Timing of one call
    """
    repeats = {name: _repeats(function) for name, function in functions.items()}
    seconds: dict[str, list[float]] = {name: [] for name in functions}
    for _ in range(rounds):
        for name, function in functions.items():
            time.sleep(REST)
            function()  # whoever ran before has left the caches to others
            start = time.perf_counter()
            for _ in range(repeats[name]):
                function()
            seconds[name].append((time.perf_counter() - start) / repeats[name])
    return {name: Timing(np.array(each)) for name, each in seconds.items()}


def _repeats(function: Callable[[], object], at_least: float = 0.03) -> int:
    """Calls in a round, so that a round is long enough to be timed; warms up as well."""
    function()
    start = time.perf_counter()
    function()
    return max(1, round(at_least / max(time.perf_counter() - start, 1e-9)))
