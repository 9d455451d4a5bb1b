"""Where a gradient was tried, and what can be asked there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from numpy_cae.verify.differences import FIRST_STEP, step_scale


@dataclass(frozen=True)
class Point:
    """Where a gradient was tried: the function, its arguments, and the argument in question."""

    f: Callable
    inputs: Sequence[np.ndarray]
    position: int
    names: Sequence[str]
    value: np.ndarray
    dy: np.ndarray
    gradient: np.ndarray

    @property
    def x(self) -> np.ndarray:
        return self.inputs[self.position]

    @property
    def name(self) -> str:
        return self.names[self.position]

    def moved_to(self, x: np.ndarray) -> np.ndarray:
        """f with this argument at x. Copies, lest f alter its arguments and so the point."""
        arguments = [x if i == self.position else a.copy() for i, a in enumerate(self.inputs)]
        return np.asarray(self.f(*arguments)[0])

    def pulled(self, dy: np.ndarray, inputs: Sequence[np.ndarray] | None = None) -> np.ndarray:
        """The pullback's gradient for this argument, with another dy or at other inputs."""
        arguments = [a.copy() for a in (self.inputs if inputs is None else inputs)]
        pulled = self.f(*arguments)[1](dy)
        return np.asarray(pulled[self.position] if isinstance(pulled, tuple | list) else pulled)


def gradient_by_differences(at: Point, dy: np.ndarray | None = None) -> np.ndarray:
    """The whole gradient, entry by entry, for dy or the point's own."""
    dy = at.dy if dy is None else dy
    numeric = np.empty(at.x.shape)
    steps = FIRST_STEP * step_scale(at.x)
    for index in np.ndindex(at.x.shape):
        plus, minus = at.x.copy(), at.x.copy()
        plus[index] += steps[index]
        minus[index] -= steps[index]
        rise = np.sum(dy * (at.moved_to(plus) - at.moved_to(minus)))
        numeric[index] = rise / (plus[index] - minus[index])
    return numeric
