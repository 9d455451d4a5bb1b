"""Many takes of many people.

Everything is determined by one seed: take n of a series by (seed, n) and its person by (seed,
number of the person), so that any take can be made again without those before it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from data_synth.body import draw_body
from data_synth.kinds import KINDS, make_take, require_kinds
from data_synth.take import Take

TAKES_A_PERSON = 12
CMU_TAKES = 2605
CMU_WINDOWS = 9673
"""Recordings in the CMU database and windows that holden2015, section 4, cuts from them."""
_LENGTH = 160
_STEP = 80
_RATE = 30.0
_PEOPLE = 1
_TAKES = 2


@dataclass(frozen=True)
class Plan:
    """The parameters of a take.

    Parameters
    ----------
    seed : int
        Of the series.
    number, person : int
        Counted from 1.
    kind : str
    seconds : float
    """

    seed: int
    number: int
    person: int
    kind: str
    seconds: float

    @property
    def name(self) -> str:
        """The name of the file, person and trial as in the CMU database, such as ``02_01``."""
        trial = (self.number - 1) % TAKES_A_PERSON + 1
        return f"{self.person:02d}_{trial:02d}"

    def make(self, rate: float = 120.0) -> Take:
        """The take itself, at `rate` frames a second."""
        body = draw_body(np.random.default_rng([self.seed, _PEOPLE, self.person]))
        rng = np.random.default_rng([self.seed, _TAKES, self.number])
        return make_take(self.kind, rng, self.seconds, rate, body=body)


def plan_takes(minutes: float, seed: int = 0, kinds: Sequence[str] | None = None) -> list[Plan]:
    """Takes of 5 to 20 seconds that together last `minutes`, every kind equally often.

    Parameters
    ----------
    minutes : float
    seed : int
        0 or more.
    kinds : sequence of str, optional
        By default all of `KINDS`.

    Raises
    ------
    ValueError
        If `minutes` is not above 0, the seed is negative or a kind is not known.
    """
    if not (np.isfinite(minutes) and minutes > 0):
        raise ValueError(f"minutes is {minutes}, expected a number above 0")
    rng = _series_rng(seed)
    remaining = 60.0 * minutes
    lengths = []
    while remaining > 1e-9:
        seconds = min(float(np.clip(np.exp(rng.normal(np.log(9.0), 0.35)), 5.0, 20.0)), remaining)
        # A remainder of less than 3 s is added to the last take.
        if remaining - seconds < 3.0:
            seconds = remaining
        lengths.append(seconds)
        remaining -= seconds
    return _plans(seed, rng, lengths, kinds)


def plan_cmu_scale(seed: int = 0, kinds: Sequence[str] | None = None) -> list[Plan]:
    """As many takes and windows as the CMU database: 2605 takes that make 9673 windows.

    A window has 160 frames at 30 Hz and starts 80 frames after the one before (holden2015,
    section 4); a take of n windows lasts between 80n and 80(n+1) frames, one shorter than a window
    holds its last pose.
    """
    rng = _series_rng(seed)
    more = rng.multinomial(CMU_WINDOWS - CMU_TAKES, rng.dirichlet(np.full(CMU_TAKES, 1.2)))
    longest = _LENGTH + _STEP * more
    frames = longest - rng.integers(0, np.where(more > 0, _STEP, 100))
    return _plans(seed, rng, [float(count) / _RATE for count in frames], kinds)


def make_takes(
    minutes: float, seed: int = 0, rate: float = 120.0, kinds: Sequence[str] | None = None
) -> Iterator[Take]:
    """Generate takes that together last `minutes`.

    Raises
    ------
    ValueError
        As `plan_takes` does, before the first take.
    """
    return (plan.make(rate) for plan in plan_takes(minutes, seed, kinds))


def _series_rng(seed: int) -> np.random.Generator:
    if seed < 0:
        raise ValueError(f"seed is {seed}, expected 0 or more")
    return np.random.default_rng([seed, 0])


def _plans(seed, rng, lengths, kinds) -> list[Plan]:
    kinds = require_kinds(KINDS if kinds is None else kinds)
    order: list[str] = []
    while len(order) < len(lengths):
        order += [kinds[index] for index in rng.permutation(len(kinds))]
    return [
        Plan(seed, number, (number - 1) // TAKES_A_PERSON + 1, kind, seconds)
        for number, (seconds, kind) in enumerate(zip(lengths, order, strict=False), start=1)
    ]
