"""A curve in a notebook that grows while a loop runs."""

from __future__ import annotations

import time
from typing import Any

import numpy as np


class LiveCurve:
    """A curve of values over steps, redrawn about once a second.

    Use it as `with LiveCurve("loss") as curve: ...` and call `curve.add(value)` in each step.

    Each point of the curve is the mean of `block` values. The first value displays the drawing
    below the cell; later drawings replace it. Needs IPython.
    """

    def __init__(self, title: str, block: int = 1, seconds: float = 1.0):
        self.title = title
        self.block = block
        self.seconds = seconds
        self.values: list[float] = []
        self._display: Any = None
        self._drawn = -np.inf

    def __enter__(self) -> LiveCurve:
        return self

    def __exit__(self, *_: object) -> None:
        if self.values:
            self._draw()

    def add(self, value: float) -> None:
        """Append a value, and draw if the last drawing is older than `seconds`."""
        self.values.append(float(value))
        if time.monotonic() - self._drawn >= self.seconds:
            self._draw()

    def _draw(self) -> None:
        import matplotlib.pyplot as plt
        from IPython.display import display

        ends = np.arange(0, len(self.values), self.block)
        means = np.add.reduceat(self.values, ends) / np.diff([*ends, len(self.values)])
        figure, axes = plt.subplots(figsize=(7, 2.4))
        axes.plot(np.minimum(ends + self.block, len(self.values)), means)
        axes.set(title=self.title, xlabel="step", yscale="log")
        plt.close(figure)  # displayed here, and not once more at the end of the cell
        if self._display is None:
            self._display = display(figure, display_id=True)
        else:
            self._display.update(figure)
        self._drawn = time.monotonic()
