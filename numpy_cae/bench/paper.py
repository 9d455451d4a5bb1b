"""The paper's whole training on this machine, for its 43 + 51 + 77 + 133 minutes (section 6)."""

from __future__ import annotations

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
    """The time of a run.

    Parameters
    ----------
    batch, windows, epochs : int
        Of the run; `minutes` are scaled to the paper's epochs.
    minutes : dict, stage to float
    once : float
        Minutes that do not grow with the epochs: encoding the fixed lower layers.
    """

    batch: int
    windows: int
    epochs: int
    minutes: dict[str, float]
    once: float

    @property
    def total(self) -> float:
        """Minutes of the whole training."""
        return sum(self.minutes.values()) + self.once

    def text(self) -> str:
        """A table of the stages, with the paper's minutes."""
        scaled = "" if self.epochs == EPOCHS else f", scaled from {self.epochs} to {EPOCHS} epochs"
        lines = [
            f"batch {self.batch}, {self.windows} windows{scaled}:",
            "",
            "| stage       | minutes here | minutes in the paper |",
            "|---|---|---|",
        ]
        for stage, minutes in self.minutes.items():
            lines.append(f"| {stage:11} | {minutes:12.1f} | {MINUTES[stage]:20} |")
        lines.append(f"| all         | {self.total:12.1f} | {sum(MINUTES.values()):20} |")
        return "\n".join(lines)


def synthetic_windows(windows: int, frames: int = 160, seed: int = 0) -> np.ndarray:
    """Sums of slow sines with root mean square 0.25, as an array (windows, frames, 63)."""
    rng = np.random.default_rng(seed)
    mixing = rng.normal(size=(6, 63)).astype(np.float32) / np.sqrt(3) / 4
    out = np.empty((windows, frames, 63), np.float32)
    for window in out:
        cycles, phases = rng.uniform(0.5, 6, size=6), rng.uniform(0, 2 * np.pi, size=6)
        angles = 2 * np.pi * cycles * np.arange(frames)[:, None] / frames + phases
        np.matmul(np.sin(angles).astype(np.float32), mixing, out=window)
    return out


def run_paper(
    batch: int, epochs: int = 1, windows: int = WINDOWS, show_progress: bool = True
) -> PaperRun:
    """Train the paper's network in the paper's four stages of `epochs` each."""
    schedule = Schedule(
        layer=Stage(epochs=epochs, batch=batch),
        fine_tuning=Stage(epochs, rate=0.01, alpha=0.0, batch=batch),
    )
    data = synthetic_windows(windows)
    start = time.perf_counter()
    history = train_autoencoder(
        accelerate(ConvAutoencoder()), data, schedule, np.random.default_rng(0), show_progress
    )
    seconds = time.perf_counter() - start
    minutes = {name: each * EPOCHS / epochs / 60 for name, each in history.seconds.items()}
    once = (seconds - sum(history.seconds.values())) / 60
    return PaperRun(batch, windows, epochs, minutes, once)
