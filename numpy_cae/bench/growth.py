"""How the cost of training grows: with windows, with frames per window, with channels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from numpy_cae.bench.paper import synthetic_windows
from numpy_cae.models import ConvAutoencoder
from numpy_cae.motion.whole_file import whole_file
from numpy_cae.training import Schedule, Stage, train_autoencoder

BATCH = 16


@dataclass(frozen=True)
class Growth:
    """Seconds of one epoch of fine tuning for sizes that double.

    Parameters
    ----------
    what : str
    sizes : list of int
    seconds : list of float
    """

    what: str
    sizes: list[int]
    seconds: list[float]

    @property
    def exponent(self) -> float:
        """The p of seconds ~ size^p, by least squares over all sizes."""
        return float(np.polyfit(np.log(self.sizes), np.log(self.seconds), 1)[0])

    def text(self) -> str:
        """A line: every size with its time, and what a doubling costs."""
        pairs = ", ".join(
            f"{size}: {seconds:.2f} s"
            for size, seconds in zip(self.sizes, self.seconds, strict=True)
        )
        return f"{self.what}: {pairs}; twice as many cost {2**self.exponent:.2f} times as much"


def growth(windows: int = 128, rounds: int = 3) -> list[Growth]:
    """Double one of the three at a time, the others as in the paper (and `windows` windows)."""

    def epoch(count: int = windows, frames: int = 160, width: int = 64) -> float:
        model = ConvAutoencoder(filters=(width, 2 * width, 4 * width))
        return _epoch_seconds(model, synthetic_windows(count, frames), rounds)

    return [
        _grown("windows", [windows * factor for factor in (1, 2, 4, 8)], epoch),
        _grown("frames per window", [80, 160, 320, 640], lambda size: epoch(frames=size)),
        _grown("filters of the first layer", [16, 32, 64, 128], lambda size: epoch(width=size)),
    ]


def _grown(what: str, sizes: Sequence[int], seconds: Callable[[int], float]) -> Growth:
    return Growth(what, list(sizes), [seconds(size) for size in sizes])


def _epoch_seconds(model: ConvAutoencoder, windows: np.ndarray, rounds: int) -> float:
    """The median epoch of fine tuning; one before it to allocate the buffers."""
    schedule = Schedule(Stage(epochs=0), Stage(1, 0.01, 0.9, 0.0, BATCH))
    train_autoencoder(model, windows[: 2 * BATCH], schedule, show_progress=False)
    seconds = []
    for _ in range(rounds):
        history = train_autoencoder(model, windows, schedule, show_progress=False)
        seconds.append(history.seconds["fine tuning"])
    return float(np.median(seconds))


def draw(grown: Sequence[Growth], path: Path) -> None:
    """Both axes logarithmic, a panel for each: a slope of 1 is growth in proportion."""
    figure = Figure(figsize=(10, 3.4), layout="constrained")
    for axes, each in zip(figure.subplots(1, len(grown), sharey=True), grown, strict=True):
        sizes = np.array(each.sizes)
        axes.loglog(sizes, each.seconds, "o-", base=2, color="tab:blue", label="measured")
        first = each.seconds[0]
        line = first * sizes / sizes[0]
        axes.loglog(sizes, line, ":", base=2, color="grey", label="in proportion")
        axes.set_xticks(sizes, [str(size) for size in sizes])
        axes.set_xlabel(each.what)
        axes.set_title(f"twice as many: {2**each.exponent:.2f} × the time", fontsize="medium")
    figure.axes[0].set_ylabel("seconds an epoch")
    figure.axes[0].legend(frameon=False)
    with whole_file(path) as beside:
        figure.savefig(beside, format="png", dpi=120)
