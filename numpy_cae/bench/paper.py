"""The paper's whole training on this machine, for its 43 + 51 + 77 + 133 minutes (section 6)."""

import time
from dataclasses import dataclass

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import Schedule, Stage, train_autoencoder

WINDOWS = 9673
"""Windows of 160 frames that the paper trained on."""

MINUTES = {"layer 1": 43, "layer 2": 51, "layer 3": 77, "fine tuning": 133}
"""Minutes of each stage in the paper, on a Quadro K2000."""

EPOCHS = 25


@dataclass(frozen=True)
class PaperRun:
    """Minutes of each stage, scaled from one epoch to the paper's 25.

    `once` is the time of encoding the fixed lower layers, which does not grow with the epochs.
    """

    batch: int
    windows: int
    minutes: dict[str, float]
    once: float

    def text(self) -> str:
        """A table of the stages, with the paper's minutes."""
        lines = [f"batch {self.batch}, {self.windows} windows, scaled from 1 to {EPOCHS} epochs:\n"]
        lines += ["| stage       | minutes here | minutes in the paper |", "|---|---|---|"]
        total = sum(self.minutes.values()) + self.once
        for stage, minutes in [*self.minutes.items(), ("all", total)]:
            paper = MINUTES.get(stage, sum(MINUTES.values()))
            lines.append(f"| {stage:11} | {minutes:12.1f} | {paper:20} |")
        return "\n".join(lines)


def synthetic_windows(windows: int) -> np.ndarray:
    """Sums of six slow sines with root mean square 0.25, as an array (windows, 160, 63)."""
    rng = np.random.default_rng(0)
    mixing = rng.normal(size=(6, 63)) / np.sqrt(3) / 4
    out = np.empty((windows, 160, 63), np.float32)
    for window in out:
        cycles = rng.uniform(0.5, 6, 6) * np.linspace(0, 1, 160)[:, None] + rng.uniform(0, 1, 6)
        window[...] = np.sin(2 * np.pi * cycles) @ mixing
    return out


def run_paper(batch: int, windows: int = WINDOWS, show_progress: bool = True) -> PaperRun:
    """Train the paper's network in the paper's four stages, for one epoch each."""
    fine_tuning = Stage(1, rate=0.01, alpha=0.0, batch=batch)
    schedule = Schedule(Stage(epochs=1, batch=batch), fine_tuning)
    model, data = accelerate(ConvAutoencoder()), synthetic_windows(windows)
    start = time.perf_counter()
    history = train_autoencoder(model, data, schedule, np.random.default_rng(0), show_progress)
    once = time.perf_counter() - start - sum(history.seconds.values())
    minutes = {name: each * EPOCHS / 60 for name, each in history.seconds.items()}
    return PaperRun(batch, windows, minutes, once / 60)
