"""The times that trainings need to the same held-out error; they run in turns."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from numpy_cae.bench.convolutional import torch
from numpy_cae.bench.table import PAUSE


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
    """Trainings compared; ours is the first."""

    trainings: Sequence[Training]
    unit: str

    @property
    def target(self) -> float:
        """The lowest error that all reach."""
        return max(min(each.errors) for each in self.trainings)

    @property
    def ratios(self) -> dict[str, float]:
        """The seconds of each training to the target, divided by ours."""
        ours = self.trainings[0].seconds_to(self.target)
        return {each.name: each.seconds_to(self.target) / ours for each in self.trainings}

    def text(self) -> str:
        """A table with a row for each training."""
        seconds = f"seconds to {self.target:.3f} {self.unit}"
        names = f"training | {seconds} | ratio | seconds in all | lowest error, {self.unit}"
        lines = [f"| {names} |", "|---|--:|--:|--:|--:|"]
        for each in self.trainings:
            numbers = f"{each.seconds_to(self.target):.1f} | {self.ratios[each.name]:.2f}"
            numbers += f" | {each.seconds[-1]:.1f} | {min(each.errors):.3f}"
            lines.append(f"| {each.name} | {numbers} |")
        return "\n".join(lines)

    def data(self) -> dict:
        """For JSON: the target, the ratios, and seconds and errors of each training by turn."""
        courses = {each.name: [each.seconds, each.errors] for each in self.trainings}
        return {"target": self.target, "ratios": self.ratios, "seconds and errors": courses}


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
