"""The times that two trainings need to the same held-out error; both run in turns."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from numpy_cae.bench.convolutional import torch
from numpy_cae.bench.timing import PAUSE


@dataclass
class Training:
    """A training in `count` turns, such as epochs, with the seconds and the error after each.

    `turns` trains for one turn at each `next`; `error` measures the network on held-out motion.
    """

    name: str
    count: int
    turns: Iterator[None]
    error: Callable[[], float]
    seconds: list[float] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)

    def take_turn(self) -> None:
        """Train for one turn and measure; only the training is timed."""
        time.sleep(PAUSE)
        start = time.perf_counter()
        next(self.turns)
        before = self.seconds[-1] if self.seconds else 0.0
        self.seconds.append(before + time.perf_counter() - start)
        self.errors.append(self.error())

    def seconds_to(self, error: float) -> float:
        """The seconds of training after which the error is first at most so large."""
        turn = next(turn for turn, each in enumerate(self.errors) if each <= error)
        return self.seconds[turn]


@dataclass(frozen=True)
class Quality:
    """Two trainings compared."""

    ours: Training
    theirs: Training
    unit: str

    @property
    def target(self) -> float:
        """The lowest error that both reach."""
        return max(min(self.ours.errors), min(self.theirs.errors))

    @property
    def ratio(self) -> float:
        """The seconds of the other to the target, divided by ours."""
        return self.theirs.seconds_to(self.target) / self.ours.seconds_to(self.target)

    def text(self) -> str:
        """A table of both trainings, and the ratio."""
        target = f"{self.target:.3f} {self.unit}"
        columns = f"seconds to {target}", "seconds in all", f"last error, {self.unit}"
        lines = [f"| training | {' | '.join(columns)} |", "|---|--:|--:|--:|"]
        for each in (self.ours, self.theirs):
            seconds = f"{each.seconds_to(self.target):.1f} | {each.seconds[-1]:.1f}"
            lines.append(f"| {each.name} | {seconds} | {each.errors[-1]:.3f} |")
        return "\n".join([*lines, "", f"ratio to {target}: {self.ratio:.2f}"])

    def data(self) -> dict:
        """For JSON: the target, the ratio, and the course of both."""
        courses = {
            each.name: {"seconds": each.seconds, "errors": each.errors}
            for each in (self.ours, self.theirs)
        }
        return {"unit": self.unit, "target": self.target, "ratio": self.ratio, "courses": courses}


def train_in_turns(
    trainings: Sequence[Training], progress: Callable[[str], None] = lambda line: None
) -> None:
    """Train all, each time the one with the smallest share of its turns done, so that a change of
    the machine's speed affects all of them. `progress` gets a line of text after each turn."""
    while waiting := [each for each in trainings if len(each.errors) < each.count]:
        each = min(waiting, key=lambda one: len(one.errors) / one.count)
        each.take_turn()
        done = f"{each.name}, {len(each.errors)}/{each.count}"
        progress(f"{done}: {each.seconds[-1]:.1f} s, held-out error {each.errors[-1]:.3f}")


def require_torch() -> None:
    """Raise ValueError without PyTorch, which the trainings are compared with."""
    if torch is None:
        raise ValueError("--quality compares with PyTorch, which is not installed (package torch)")
