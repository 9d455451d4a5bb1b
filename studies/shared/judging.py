"""Whether a measured figure fulfils a rule, with the spread over takes.

The spread is that of the bootstrap (Efron 1979): the figure is computed again from as many takes,
drawn with replacement. Its interval has 95% of `DRAWS` such figures. A rule "at most b" is
fulfilled where the whole interval is at most b, and not fulfilled where the whole interval is above
b. Where b is inside, the takes do not decide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

DRAWS = 1000
"""Samples of takes, with replacement."""
COVERED = (2.5, 97.5)
"""The ends of the interval, in percent of the samples."""


@dataclass(frozen=True)
class Interval:
    """A figure of all takes, and the ends of its interval."""

    value: float
    low: float
    high: float

    def __format__(self, form: str) -> str:
        return f"{self.value:{form}} ({self.low:{form}} to {self.high:{form}})"

    def at_most(self, bound: float) -> bool | None:
        """Whether the figure is at most the bound; None where the takes do not decide."""
        if self.high <= bound:
            return True
        return False if self.low > bound else None

    def below(self, bound: float) -> bool | None:
        """Whether the figure is below the bound; None where the takes do not decide."""
        if self.high < bound:
            return True
        return False if self.low >= bound else None

    def at_least(self, bound: float) -> bool | None:
        """Whether the figure is at least the bound; None where the takes do not decide."""
        return negate(self.below(bound))

    def above(self, bound: float) -> bool | None:
        """Whether the figure is above the bound; None where the takes do not decide."""
        return negate(self.at_most(bound))


def bootstrap(figure: Callable[..., np.ndarray], *columns: np.ndarray, seed: int = 0) -> Interval:
    """A figure of numbers of takes, columns with a row for each take, and its interval.

    The figure is computed of all samples together: of columns (samples, takes, …), (samples,).
    """
    count = len(columns[0])
    drawn = np.random.default_rng(seed).integers(count, size=(DRAWS, count))
    low, high = np.percentile(figure(*(column[drawn] for column in columns)), COVERED)
    (value,) = figure(*(column[None] for column in columns))
    return Interval(float(value), float(low), float(high))


def mean_of(values: np.ndarray) -> Interval:
    """The mean of a number of each take."""
    return bootstrap(_means, np.asarray(values, dtype=np.float64))


def ratio_of_means(ours: np.ndarray, theirs: np.ndarray) -> Interval:
    """The mean of a number of each take, divided by the mean of another one of the same takes."""
    return bootstrap(_ratios_of_means, np.asarray(ours, float), np.asarray(theirs, float))


def ratio_of_samples(ours: np.ndarray, theirs: np.ndarray) -> Interval:
    """The mean of one set of numbers divided by that of another one, drawn independently."""
    ours = np.asarray(ours, dtype=np.float64)
    theirs = np.asarray(theirs, dtype=np.float64)
    rng = np.random.default_rng(0)
    drawn = []
    drawn_of_theirs = []
    for _ in range(DRAWS):
        drawn.append(rng.integers(len(ours), size=len(ours)))
        drawn_of_theirs.append(rng.integers(len(theirs), size=len(theirs)))
    ratios = _ratios_of_means(ours[np.array(drawn)], theirs[np.array(drawn_of_theirs)])
    low, high = np.percentile(ratios, COVERED)
    (value,) = _ratios_of_means(ours[None], theirs[None])
    return Interval(float(value), float(low), float(high))


def _means(samples: np.ndarray) -> np.ndarray:
    return samples.mean(axis=1)


def _ratios_of_means(ours: np.ndarray, theirs: np.ndarray) -> np.ndarray:
    return ours.mean(axis=1) / np.maximum(theirs.mean(axis=1), 1e-12)


def root_mean_square(squares: np.ndarray) -> float:
    """The root mean square of rows (sum of squares, number of values)."""
    return float(_root_mean_squares(squares[None])[0])


def _root_mean_squares(squares: np.ndarray) -> np.ndarray:
    return np.sqrt(squares[..., 0].sum(axis=1) / squares[..., 1].sum(axis=1))


def ratio_of_errors(ours: np.ndarray, theirs: np.ndarray) -> Interval:
    """The error of a method divided by that of another one, from `Clips.squares_by_take`."""

    def ratios(ours: np.ndarray, theirs: np.ndarray) -> np.ndarray:
        return _root_mean_squares(ours) / _root_mean_squares(theirs)

    return bootstrap(ratios, ours, theirs)


def all_of(*fulfilled: bool | None) -> bool | None:
    """Whether all parts of a rule are fulfilled: not where one is not, and undecided where one
    is undecided."""
    if False in fulfilled:
        return False
    return None if None in fulfilled else True


def agreed(fulfilled: Sequence[bool | None]) -> bool | None:
    """What all seeds say; None where they differ."""
    return fulfilled[0] if len(set(fulfilled)) == 1 else None


def seeds_below(ours: Sequence[float], theirs: Sequence[float]) -> bool | None:
    """Whether a number is lower than another one with each seed; None where seeds differ."""
    return agreed([ours < theirs for ours, theirs in zip(ours, theirs, strict=True)])


def negate(fulfilled: bool | None) -> bool | None:
    """The opposite, where it is decided."""
    return None if fulfilled is None else not fulfilled
